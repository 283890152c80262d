// The collapses of a mesh, region by region, cheapest first, and the kernel that carries them out: compiled for AVX2
// and for any processor, equal bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/base/instruction_set.h"
#include "core/progressive/collapse/collapse_metric.h"
#include "core/progressive/collapse/ring_mesh.h"

namespace lodestone::progressive {

// A collapse as it happened. `order` does not decrease within a region.
struct CollapseRecord {
  Id vertex = no_id;
  std::uint16_t triangles = 0;  // 1 or 2 that vanished
  std::uint16_t ring = 0;       // the number of neighbours that the vertex had
  float order = 0;              // the largest rank so far
  float error = 0;              // of this collapse
};

// Vertices that may collapse together: the whole ring of each is in the region.
struct Region {
  std::span<const Id> vertices;                                         // in an order that depends on the mesh alone
  float max_rank = std::numeric_limits<float>::infinity();              // collapses of higher rank wait
  std::size_t max_triangles = std::numeric_limits<std::size_t>::max();  // the region stops after so many collapsed
};

struct VertexState {
  enum Bits : std::uint16_t {
    dirty = 1,   // its ring has changed since it was evaluated
    queued = 2,  // in the queue of the region that runs
    member = 4   // of that region
  };
  float rank = std::numeric_limits<float>::infinity();  // when it was last evaluated
  std::uint16_t target = 0;                             // the cheapest, by its place in the ring
  std::uint16_t bits = 0;

  [[nodiscard]] bool has(Bits b) const { return (bits & b) != 0; }
  void clear(int b) { bits = static_cast<std::uint16_t>(bits & ~b); }
};

struct CollapseState {
  RingMesh& rings;
  CollapseMetric& metric;
  std::vector<VertexState> vertices;
  std::vector<Id> parent;  // by wedge (by vertex, without wedges): what it collapsed into; no_id: still there
};

struct CollapseKernel {
  ChainFan chain;  // of at most eight triangles; eight ids can be read
  // The quadrics of vertices [begin, end) in the input (star_quadrics.h).
  void (*star_quadrics)(const RingMesh& rings, std::size_t begin, std::size_t end, CentredQuadric* quadrics);
  // Their first ranks: what they would cost if the surface allowed everything.
  void (*start)(CollapseState& state, std::size_t begin, std::size_t end);
  std::vector<CollapseRecord> (*run)(CollapseState& state, const Region& region, RingArena& arena);
};
// The build for AVX2 is null where the compiler does not know it.
extern const CollapseKernel *const plain_collapse_kernel, *const avx2_collapse_kernel;
// Throws UnsupportedError where the set is not available.
[[nodiscard]] const CollapseKernel& collapse_kernel(InstructionSet set);

class Collapser {
 public:
  Collapser(RingMesh& rings, CollapseMetric& metric, const CollapseKernel& kernel);

  // The first ranks of all vertices; may run side by side.
  void start(std::size_t begin, std::size_t end) { kernel_.start(state_, begin, end); }
  // The cost of collapsing a vertex when it was last evaluated; infinite if it cannot collapse.
  [[nodiscard]] float rank(Id v) const { return state_.vertices[v].rank; }
  // Regions that share no vertex may run side by side, each with an arena that lives as long as the mesh.
  [[nodiscard]] std::vector<CollapseRecord> run(const Region& region, RingArena& arena) {
    return kernel_.run(state_, region, arena);
  }
  // By wedge (by vertex, without wedges): what it collapsed into; no_id: still there.
  [[nodiscard]] const std::vector<Id>& parents() const { return state_.parent; }
  [[nodiscard]] std::vector<Id> take_parents() { return std::move(state_.parent); }

 private:
  const CollapseKernel& kernel_;
  CollapseState state_;
};

}  // namespace lodestone::progressive
