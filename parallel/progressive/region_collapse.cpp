#include "parallel/progressive/region_collapse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/prefetch.h"
#include "core/progressive/collapse/collapse_metric.h"
#include "parallel/progressive/merge_records.h"

namespace lodestone {
namespace {

using progressive::CollapseRecord;

constexpr std::size_t vertex_grain = 4096;
constexpr std::size_t region_vertices = 1500;  // of a region, about
constexpr std::size_t whole_triangles = 6000;  // collapsed as one
constexpr double round_share = 0.9;            // of the vertices rank low enough to go in a round

// Cubes of a grid, shifted from round to round.
class Grid {
 public:
  Grid(std::size_t vertices, std::size_t round) {
    // A surface through a unit cube meets about 2 n^2 of n^3 cubes.
    const double wanted = std::sqrt(static_cast<double>(vertices) / (2.0 * region_vertices));
    cubes_ = std::clamp(static_cast<std::uint32_t>(std::lround(wanted)), 1u, 200u);
    constexpr std::array<double, 3> steps{0.5, 0.6180339887, 0.7548776662};
    for (int axis = 0; axis < 3; ++axis) {
      const double shift = steps[static_cast<std::size_t>(axis)] * static_cast<double>(round);
      shift_[axis] = static_cast<float>(shift - std::floor(shift));
    }
  }
  [[nodiscard]] std::uint32_t count() const { return (cubes_ + 1) * (cubes_ + 1) * (cubes_ + 1); }
  [[nodiscard]] std::uint32_t cube(Vec3f p) const {
    const auto at = [&](float x, int axis) {
      return static_cast<std::uint32_t>(x * static_cast<float>(cubes_) + shift_[axis]);
    };
    return (at(p.z, 2) * (cubes_ + 1) + at(p.y, 1)) * (cubes_ + 1) + at(p.x, 0);
  }

 private:
  std::uint32_t cubes_ = 1;
  float shift_[3]{};
};

}  // namespace

RegionCollapse::RegionCollapse(const IndexedMesh& mesh, const ProgressiveConfig& config, Scheduler& scheduler)
    : mesh_(mesh),
      config_(config),
      scheduler_(scheduler),
      kernel_(progressive::collapse_kernel(config.instructions)),
      rings_(mesh),
      triangles_(mesh.triangles.size()) {
  make_rings();
}

template <class Body>
void RegionCollapse::for_vertices(const Body& body) {
  scheduler_.for_chunks(rings_.vertex_count(), vertex_grain, [&](ChunkRange c) { body(c.begin, c.end); });
}

void RegionCollapse::run() {
  metric_ = progressive::make_metric(config_.metric, rings_, mesh_, config_.weights, kernel_);
  collapser_.emplace(rings_, *metric_, kernel_);
  // Ranks by planes need those of the vertex alone: both at once, while its star is in the cache.
  const bool at_once = metric_->plane_quadrics() != nullptr;
  for_vertices([&](std::size_t begin, std::size_t end) {
    metric_->start(begin, end);
    if (at_once) collapser_->start(begin, end);
  });
  if (!at_once) for_vertices([&](std::size_t begin, std::size_t end) { collapser_->start(begin, end); });
  list_vertices();
  const std::size_t enough = std::max(whole_triangles, config_.base_triangles);
  for (std::size_t before = 0; triangles_ > enough && triangles_ != before; ++rounds_) {
    before = triangles_;
    collapse_regions(rounds_);
  }
  collapse_rest();
  metric_.reset();
}

std::vector<progressive::Id> RegionCollapse::take_parents() {
  std::vector<progressive::Id> parents = collapser_->take_parents();
  collapser_.reset();
  return parents;
}

void RegionCollapse::free_rings() {
  rings_.free_rings();
  arenas_.clear();
  live_ = std::vector<progressive::Id>(), sorted_ = std::vector<progressive::Id>();
  cube_ = std::vector<std::uint32_t>();
}

void RegionCollapse::make_rings() {
  rings_.list_corners();
  const std::size_t first_arena = arenas_.size(), count = mesh_.positions.size();
  arenas_.resize(first_arena + chunk_count(count, vertex_grain));
  scheduler_.for_chunks(count, vertex_grain, [&](ChunkRange c) {
    rings_.make_rings(c.begin, c.end, arenas_[first_arena + c.index], kernel_.chain);
  });
  rings_.cut_open();
}

void RegionCollapse::list_vertices() {
  live_.reserve(rings_.vertex_count()), records_.reserve(rings_.vertex_count());
  for (progressive::Id v = 0; v < rings_.vertex_count(); ++v)
    if (rings_.is_used(v)) live_.push_back(v);
}

// The rank that a share of the vertices is below, of a sample.
float RegionCollapse::rank_limit() const {
  constexpr std::size_t sample = 5000;
  std::vector<float> ranks;
  const std::size_t step = live_.size() / sample + 1;
  for (std::size_t k = 0; k < live_.size(); k += step)
    if (std::isfinite(collapser_->rank(live_[k]))) ranks.push_back(collapser_->rank(live_[k]));
  if (ranks.empty()) return 0;
  const auto at = ranks.begin() + static_cast<std::ptrdiff_t>(round_share * static_cast<double>(ranks.size() - 1));
  std::nth_element(ranks.begin(), at, ranks.end());
  return *at;
}

void RegionCollapse::collapse_regions(std::size_t round) {
  const Grid grid(live_.size(), round);
  cube_.resize(rings_.vertex_count());
  scheduler_.for_chunks(live_.size(), vertex_grain, [&](ChunkRange c) {
    for (std::size_t k = c.begin; k < c.end; ++k) cube_[live_[k]] = grid.cube(rings_.position(live_[k]));
  });
  sort_by_cube(grid.count());
  const float limit = rank_limit();
  std::vector<std::vector<CollapseRecord>> records(regions_.size());
  const std::size_t first_arena = arenas_.size();
  arenas_.resize(first_arena + regions_.size());
  // The largest first, so that no worker is left with one at the end.
  std::vector<std::size_t> turn(regions_.size());
  std::iota(turn.begin(), turn.end(), std::size_t{0});
  const auto size = [&](std::size_t r) { return regions_[r].second - regions_[r].first; };
  std::stable_sort(turn.begin(), turn.end(), [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
  scheduler_.for_chunks(regions_.size(), 1, [&](ChunkRange c) {
    const std::size_t r = turn[c.index];
    std::vector<progressive::Id> free;
    free.reserve(size(r));
    for (std::size_t k = regions_[r].first; k < regions_[r].second; ++k) {
      prefetch(&rings_.ring(sorted_[std::min(k + prefetch_distance, regions_[r].second - 1)]));
      if (is_inside(sorted_[k])) free.push_back(sorted_[k]);
    }
    records[r] = collapser_->run({.vertices = free, .max_rank = limit}, arenas_[first_arena + r]);
    const auto begin = sorted_.begin() + static_cast<std::ptrdiff_t>(regions_[r].first),
               end = begin + static_cast<std::ptrdiff_t>(size(r));
    regions_[r].second = static_cast<std::size_t>(
        std::remove_if(begin, end, [&](progressive::Id v) { return !rings_.is_used(v); }) - sorted_.begin());
  });
  const std::size_t before = records_.size();
  merge_records(records, records_, scheduler_);
  count_triangles(before);
  live_.clear();
  for (const auto& [first, last] : regions_)
    live_.insert(live_.end(), sorted_.begin() + static_cast<std::ptrdiff_t>(first),
                 sorted_.begin() + static_cast<std::ptrdiff_t>(last));
}

bool RegionCollapse::is_inside(progressive::Id v) const {
  std::uint32_t differs = 0;  // no early end: that could not be predicted
  for (const progressive::Id x : rings_.ring(v).neighbours()) differs |= cube_[x] ^ cube_[v];
  return differs == 0;
}

// By a counting sort; regions_ are the ranges of the cubes that have vertices.
void RegionCollapse::sort_by_cube(std::uint32_t cubes) {
  std::vector<std::uint32_t> first(cubes + 1, 0);
  for (const progressive::Id v : live_) ++first[cube_[v] + 1];
  for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
  regions_.clear();
  for (std::size_t k = 0; k < cubes; ++k)
    if (first[k] < first[k + 1]) regions_.emplace_back(first[k], first[k + 1]);
  sorted_.resize(live_.size());
  for (const progressive::Id v : live_) sorted_[first[cube_[v]]++] = v;
}

void RegionCollapse::collapse_rest() {
  const std::size_t most = triangles_ - std::min(triangles_, config_.base_triangles);
  arenas_.emplace_back();
  const std::size_t before = records_.size();
  const auto rest = collapser_->run(
      {.vertices = live_, .max_rank = std::numeric_limits<float>::infinity(), .max_triangles = most}, arenas_.back());
  records_.insert(records_.end(), rest.begin(), rest.end());
  count_triangles(before);
}

// Subtracts the triangles of the records from here on.
void RegionCollapse::count_triangles(std::size_t from) {
  for (std::size_t k = from; k < records_.size(); ++k) triangles_ -= records_[k].triangles;
}

}  // namespace lodestone
