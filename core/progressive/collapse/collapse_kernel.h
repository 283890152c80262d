// What collapses, and the kernel that does it in lanes: compiled for AVX2 and for any processor, equal bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/instruction_set.h"
#include "core/progressive/collapse/collapse_metric.h"
#include "core/progressive/collapse/plane_quadric.h"
#include "core/progressive/collapse/ring_mesh.h"

namespace lodestone::progressive {

// A collapse as it happened. `order` does not decrease within a region.
struct CollapseRecord {
  Id vertex = no_id;
  std::uint32_t triangles = 0;  // that vanished, 1 or 2
  float order = 0;              // the largest rank so far
  float error = 0;              // of this collapse
};

// Which vertices may collapse together: all of a region have their whole ring in it.
struct Region {
  std::span<const Id> vertices;  // that may collapse, in an order that depends on the mesh alone
  float most_rank = std::numeric_limits<float>::infinity();              // collapses of higher rank wait
  std::size_t most_triangles = std::numeric_limits<std::size_t>::max();  // to collapse; there the region stops
};

// How a vertex stands in the queue.
struct Standing {
  enum Bits : std::uint16_t {
    dirty = 1,   // its ring is another one than when it was looked at
    queued = 2,  // in the queue of the region that runs
    member = 4   // of that region
  };
  float rank = std::numeric_limits<float>::infinity();  // as of when it was looked at last
  std::uint16_t target = 0;                             // the cheapest, by its place in the ring
  std::uint16_t bits = 0;
};

struct CollapseState {
  RingMesh& rings;
  CollapseMetric& metric;
  std::vector<Standing> standing;  // by vertex
  std::vector<Id> parent;          // by wedge (by vertex, without wedges): what it collapsed into; no_id: still there
};

struct CollapseKernel {
  ChainFan chain;  // of at most eight triangles; eight ids can be read
  // The quadrics of vertices [begin, end) in the input (star_quadrics.h).
  void (*star_quadrics)(const RingMesh& rings, std::size_t begin, std::size_t end, PlaneQuadric* quadrics);
  // Their first ranks: what they would cost if the surface allowed everything.
  void (*start)(CollapseState& state, std::size_t begin, std::size_t end);
  std::vector<CollapseRecord> (*run)(CollapseState& state, const Region& region, RingArena& arena);
};
extern const CollapseKernel plain_collapse_kernel, avx2_collapse_kernel;
// Throws UnsupportedError where the set is not available.
[[nodiscard]] const CollapseKernel& collapse_kernel(InstructionSet set);

}  // namespace lodestone::progressive
