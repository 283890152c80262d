// The collapse kernel: one region of a mesh, cheapest collapse first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/progressive/collapse_metric.h"
#include "core/progressive/ring_mesh.h"

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

class Collapser {
 public:
  Collapser(RingMesh& rings, CollapseMetric& metric);

  // The first ranks of all vertices; may run side by side.
  void start(std::size_t begin, std::size_t end);
  // What a vertex would cost, as of when it was looked at last; infinite: it cannot collapse.
  [[nodiscard]] float rank(Id v) const { return rank_[v]; }
  // Regions that share no vertex may run side by side, each with an arena that lives as long as the mesh.
  [[nodiscard]] std::vector<CollapseRecord> run(const Region& region, RingArena& arena);
  // By wedge (by vertex, without wedges): what it collapsed into; no_id: still there.
  [[nodiscard]] const std::vector<Id>& parents() const { return parent_; }

 private:
  class Queue;
  void look(Id v);
  [[nodiscard]] bool turns(const Collapse& collapse) const;
  bool collapse(Id v, Queue& queue, RingArena& arena, CollapseRecord& record);

  RingMesh& rings_;
  CollapseMetric& metric_;
  std::vector<float> rank_;
  std::vector<Id> target_, parent_;
  std::vector<std::uint8_t> state_;  // bits: dirty, queued, member of the region that runs
};

}  // namespace lodestone::progressive
