#include "experiments/metrics/pops/pops.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "experiments/metrics/drawn/screen.h"

namespace lodestone {
namespace {

constexpr std::size_t pairs_per_chunk = 4;

// A cell drawn in one frame and what draws the same triangles in the other one: itself, an ancestor or a descendant.
struct DrawnPair {
  SelectedCell before, after;
  [[nodiscard]] const SelectedCell& finer() const { return before.level >= after.level ? before : after; }
};

// Cells of level L below a cell: consecutive, since children are.
struct LeafInterval {
  CellId begin, end;
};

LeafInterval leaves_below(const Hierarchy& hierarchy, const SelectedCell& selected) {
  CellId first = selected.cell, last = selected.cell;
  for (int level = selected.level; level < hierarchy.finest(); ++level) {
    const Cell& cell = hierarchy.cells[last];
    first = hierarchy.cells[first].first_child;
    last = CellId(cell.end_child() - 1);
  }
  return {first, CellId(last + 1)};
}

// Both selections tile the leaves in their order with intervals, which are nested or apart. One pass over both.
std::vector<DrawnPair> pair_cells(const Hierarchy& hierarchy, const Selection& before, const Selection& after) {
  std::vector<DrawnPair> pairs;
  std::size_t i = 0, j = 0;
  CellId begin_before = hierarchy.levels.back().first_cell, begin_after = begin_before;
  bool tiled = true;
  while (tiled && i < before.cells.size() && j < after.cells.size()) {
    const LeafInterval a = leaves_below(hierarchy, before.cells[i]), b = leaves_below(hierarchy, after.cells[j]);
    tiled = a.begin == begin_before && b.begin == begin_after;
    pairs.push_back({before.cells[i], after.cells[j]});
    if (a.end <= b.end) begin_before = a.end, ++i;
    if (b.end <= a.end) begin_after = b.end, ++j;
  }
  if (!tiled || begin_before != hierarchy.cells.size() || begin_after != begin_before)
    throw InputError("the selections of the two frames are not partitions of the surface; select with keep_culled");
  return pairs;
}

// Largest bound over the levels that lie between the two, both included.
double bound_between(std::span<const double> bounds, int level, int other) {
  const auto [low, high] = std::minmax(level, other);
  return *std::max_element(bounds.begin() + low, bounds.begin() + high + 1);
}

// Largest way of a vertex of one level to what another one draws it as: to the parent, level by level.
double way_between(const Hierarchy& hierarchy, int level, int other) {
  const auto [low, high] = std::minmax(level, other);
  double way = 0;
  for (int l = std::max(low, 1); l <= high; ++l) way += hierarchy.displacement_bound(l);
  return way;
}

// The vertices of the finer cell of a pair, where the frame draws them in its own cell of the pair: index there.
VertexId drawn_vertex(const Hierarchy& hierarchy, const SelectedCell& finer, VertexId vertex,
                      const SelectedCell& drawn) {
  for (CellId cell = finer.cell; cell != drawn.cell; cell = hierarchy.cells[cell].parent)
    vertex = VertexId(hierarchy.cells[cell].parents[vertex]);
  return vertex;
}

// Drawn positions of one cell, remembered while consecutive pairs share it.
class MorphedCell {
 public:
  std::span<const Vec3f> positions(const MorphContext& context, CellId cell) {
    if (cell != cell_) {
      positions_.resize(context.hierarchy->cells[cell].positions.size());
      morph_cell(context, cell, positions_);
      cell_ = cell;
    }
    return positions_;
  }

 private:
  CellId cell_ = no_cell;
  std::vector<Vec3f> positions_;
};

struct Band {
  double begin = 0, end = 0;
};

Band band_of(const MorphContext& context, std::size_t level) {
  return {context.radii->band_begin[level], context.radii->band_end[level]};
}

// The largest change of a radius that moves vertices of the level: of their own cells or of the parents.
double radius_shift(const MorphContext& before, const MorphContext& after, std::size_t level) {
  double shift = 0;
  for (const std::size_t l : {level - 1, level}) {
    const Level& cells = before.hierarchy->levels[l];
    for (CellId c = cells.first_cell; c < cells.end_cell(); ++c)
      shift = std::max(shift, std::abs(double{after.radii->by_cell[c]} - before.radii->by_cell[c]));
  }
  return shift;
}

double step_length(const MorphContext& before, const MorphContext& after) {
  return length(to_double(after.viewpoint) - to_double(before.viewpoint));
}

// The inputs that all jumps between two frames share.
struct Frames {
  const MorphContext &before, &after;
  std::span<const DrawnPair> pairs;
  std::span<const double> bounds;
  const JumpConfig& config;
};

// The report of some pairs, and the jumps > 0 of which percentiles are taken.
struct Part {
  PopReport report;
  std::vector<double> jumps, pixels;
};

// The earlier of two equal maxima is kept, so that chunks combine in their order to the same result.
void keep_larger(const VertexJump& largest, const VertexJump& worst, PopReport& report) {
  if (largest.jump > report.max_jump) {
    report.max_jump = largest.jump;
    report.largest = largest;
  }
  if (worst.ratio > report.jump_over_bound) {
    report.jump_over_bound = worst.ratio;
    report.worst = worst;
  }
}

void add_seen(const VertexJump& jump, const Screen& screen, Part& part) {
  const auto to = screen.project(to_double(jump.to));
  const auto from = jump.from == jump.to ? to : screen.project(to_double(jump.from));
  if (!from || !to || !(from->inside || to->inside)) return;
  ++part.report.vertices_in_view;
  const double seen = distance(*from, *to);
  if (!(seen > 0)) return;
  part.report.max_jump_pixels = std::max(part.report.max_jump_pixels, seen);
  part.pixels.push_back(seen);
}

void add_jump(VertexJump& jump, const JumpConfig& config, Part& part) {
  if (config.screen) add_seen(jump, *config.screen, part);
  if (jump.from == jump.to) return;
  jump.jump = length(to_double(jump.to) - to_double(jump.from));
  jump.ratio = jump_ratio(jump.jump, jump.bound);
  if (jump.ratio > 1) ++part.report.above_bound;
  keep_larger(jump, jump, part.report);
  if (config.percentiles) part.jumps.push_back(jump.jump);
}

Part jumps_of(const Frames& frames, ChunkRange chunk) {
  const Hierarchy& hierarchy = *frames.before.hierarchy;
  Part part;
  MorphedCell morphed_before, morphed_after;
  for (const DrawnPair& pair : frames.pairs.subspan(chunk.begin, chunk.end - chunk.begin)) {
    const SelectedCell& finer = pair.finer();
    const std::span<const Vec3f> from = morphed_before.positions(frames.before, pair.before.cell);
    const std::span<const Vec3f> to = morphed_after.positions(frames.after, pair.after.cell);
    VertexJump jump;
    jump.bound = bound_between(frames.bounds, pair.before.level, pair.after.level);
    jump.way = way_between(hierarchy, pair.before.level, pair.after.level);
    jump.cell = finer.cell;
    jump.level_from = pair.before.level;
    jump.level_to = pair.after.level;
    const std::size_t vertices = hierarchy.cells[finer.cell].positions.size();
    part.report.vertices += vertices;
    for (VertexId v{0}; v < vertices; ++v) {
      jump.vertex = v;
      jump.from = from[drawn_vertex(hierarchy, finer, v, pair.before)];
      jump.to = to[drawn_vertex(hierarchy, finer, v, pair.after)];
      add_jump(jump, frames.config, part);
    }
  }
  return part;
}

// The 99th percentile of `count` jumps, of which all but those listed are 0. Empties the lists.
double p99_of(std::vector<Part>& parts, std::vector<double> Part::*list, std::uint64_t count) {
  std::vector<double> moved;
  for (Part& part : parts) {
    moved.insert(moved.end(), (part.*list).begin(), (part.*list).end());
    part.*list = {};
  }
  const auto not_above = static_cast<std::uint64_t>(std::ceil(0.99 * static_cast<double>(count)));
  const std::uint64_t at_rest = count - moved.size();
  if (not_above <= at_rest) return 0;
  const auto at = moved.begin() + static_cast<std::ptrdiff_t>(not_above - at_rest - 1);
  std::nth_element(moved.begin(), at, moved.end());
  return *at;
}

}  // namespace

double jump_ratio(double jump, double bound) {
  const double excess = jump - jump_rounding;
  if (!(excess > 0)) return 0;
  return bound > 0 ? excess / bound : std::numeric_limits<double>::infinity();
}

std::vector<double> jump_bounds(const MorphContext& before, const MorphContext& after, double limit_rate) {
  const Hierarchy& hierarchy = *before.hierarchy;
  const double step = step_length(before, after), sinking = -2 * std::log1p(-limit_rate);
  std::vector<double> bounds(hierarchy.levels.size(), 0);
  for (std::size_t l = 1; l < bounds.size(); ++l) {
    const Band from = band_of(before, l), to = band_of(after, l);
    const double width = std::min(from.end - from.begin, to.end - to.begin);
    const double lipschitz =
        width > 0 ? blend_lipschitz(before.blend) / width : std::numeric_limits<double>::infinity();
    const bool adaptive = !before.radii->by_cell.empty() && !after.radii->by_cell.empty();
    const double shift = adaptive ? radius_shift(before, after, l)
                                  : std::max(std::abs(to.begin - from.begin), std::abs(to.end - from.end));
    const double way = step + shift + sinking * std::max(from.end, to.end) + view_rounding * std::max(from.end, to.end);
    bounds[l] = hierarchy.displacement_bound(static_cast<int>(l)) * lipschitz * way;
  }
  return bounds;
}

PopReport largest_jump(const MorphContext& before, const Selection& selected_before, const MorphContext& after,
                       const Selection& selected_after, Scheduler& scheduler, const JumpConfig& config) {
  assert(before.hierarchy == after.hierarchy && before.blend == after.blend);
  assert(before.radii->metric == after.radii->metric);
  const Hierarchy& hierarchy = *before.hierarchy;
  const std::vector<DrawnPair> pairs = pair_cells(hierarchy, selected_before, selected_after);

  PopReport report;
  report.step = step_length(before, after);
  const std::vector<double> own_bounds =
      config.bounds.empty() ? jump_bounds(before, after, config.limit_rate) : std::vector<double>{};
  const std::span<const double> bounds = config.bounds.empty() ? own_bounds : config.bounds;
  assert(bounds.size() == hierarchy.levels.size());
  report.bounded = bounds.size() > 1 && std::all_of(bounds.begin(), bounds.end(), [](double b) {
                     return b < std::numeric_limits<double>::infinity();
                   });

  const Frames frames{before, after, pairs, bounds, config};
  std::vector<Part> parts(chunk_count(pairs.size(), pairs_per_chunk));
  scheduler.for_chunks(pairs.size(), pairs_per_chunk,
                       [&](ChunkRange chunk) { parts[chunk.index] = jumps_of(frames, chunk); });
  for (const auto& [part, jumps, pixels] : parts) {
    report.above_bound += part.above_bound;
    report.vertices += part.vertices;
    report.vertices_in_view += part.vertices_in_view;
    report.max_jump_pixels = std::max(report.max_jump_pixels, part.max_jump_pixels);
    keep_larger(part.largest, part.worst, report);
  }
  report.vacuous = report.jump_over_bound > 0 && report.worst.bound >= report.worst.way;
  if (config.percentiles) {
    report.p99_jump = p99_of(parts, &Part::jumps, report.vertices);
    report.p99_jump_pixels = p99_of(parts, &Part::pixels, report.vertices_in_view);
  }
  return report;
}

}  // namespace lodestone
