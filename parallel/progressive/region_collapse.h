// Half-edge collapses of a whole mesh on all cores, region by region, cheapest first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/progressive/collapse/collapse_kernel.h"
#include "core/progressive/collapse/collapse_metric.h"
#include "parallel/progressive/make_progressive.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// While the mesh is large, collapses happen in the cubes of a grid that moves from round to round; the rest is one
// region. The result depends only on the mesh and the configuration.
class RegionCollapse {
 public:
  // Makes the rings. All three must outlive it. Throws InputError when the mesh lacks what the metric measures.
  RegionCollapse(const IndexedMesh& mesh, const ProgressiveConfig& config, Scheduler& scheduler);

  // Collapses until no more than config.base_triangles remain, or nothing can collapse.
  void run();

  [[nodiscard]] progressive::RingMesh& rings() { return rings_; }
  // In the order in which they happened.
  [[nodiscard]] std::vector<progressive::CollapseRecord>& records() { return records_; }
  [[nodiscard]] const std::vector<progressive::Id>& parents() const { return collapser_->parents(); }
  // The same, for good: nothing collapses any more.
  [[nodiscard]] std::vector<progressive::Id> take_parents();
  // Frees the rings and what only collapses need.
  void free_rings();
  [[nodiscard]] std::size_t triangles_left() const { return triangles_; }
  [[nodiscard]] std::size_t rounds() const { return rounds_; }

 private:
  template <class Body>
  void for_vertices(const Body& body);
  void make_rings();
  void list_vertices();
  [[nodiscard]] float rank_limit() const;
  void collapse_regions(std::size_t round);
  [[nodiscard]] bool is_inside(progressive::Id v) const;
  void sort_by_cube(std::uint32_t cubes);
  void collapse_rest();
  void count_triangles(std::size_t from);

  const IndexedMesh& mesh_;
  const ProgressiveConfig& config_;
  Scheduler& scheduler_;
  const progressive::CollapseKernel& kernel_;
  progressive::RingMesh rings_;
  std::unique_ptr<progressive::CollapseMetric> metric_;
  std::optional<progressive::Collapser> collapser_;
  std::deque<progressive::RingArena> arenas_;
  std::vector<progressive::Id> live_, sorted_;
  std::vector<std::uint32_t> cube_;
  std::vector<std::pair<std::size_t, std::size_t>> regions_;
  std::vector<progressive::CollapseRecord> records_;
  std::size_t triangles_ = 0, rounds_ = 0;
};

}  // namespace lodestone
