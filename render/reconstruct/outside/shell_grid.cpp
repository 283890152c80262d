#include "render/reconstruct/outside/shell_grid.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lodestone {
namespace {

constexpr std::uint64_t all_solid = ~std::uint64_t{0};
constexpr int margin = 2;  // points beside the box: what surrounds them is free

}  // namespace

ShellGrid::ShellGrid(const FreeSpace& space, const Box3f& box, double spacing, Scheduler& scheduler)
    : space_(space), spacing_(spacing) {
  // A shift by an odd share of the spacing: faces of a box would otherwise pass through points.
  constexpr double shift = 0.37;
  const Vec3d lo = to_double(box.lo), hi = to_double(box.hi);
  origin_ = lo - (margin + shift) * spacing * Vec3d{1, 1, 1};
  const auto side = [&](double extent) {
    return static_cast<int>(std::ceil((extent / spacing + 2 * margin + 2) / block_side));
  };
  side_[0] = side(hi.x - lo.x), side_[1] = side(hi.y - lo.y), side_[2] = side(hi.z - lo.z);
  solid_.resize(static_cast<std::size_t>(side_[0]) * static_cast<std::size_t>(side_[1]) *
                static_cast<std::size_t>(side_[2]));
  scheduler.for_chunks(solid_.size(), 64, [&](ChunkRange range) {
    for (std::size_t b = range.begin; b < range.end; ++b) carve(b);
  });
  find_sheets(scheduler);
}

GridPoint ShellGrid::first_point(std::size_t block) const {
  const auto nx = static_cast<std::size_t>(side_[0]), ny = static_cast<std::size_t>(side_[1]);
  return {static_cast<int>(block % nx) * block_side, static_cast<int>(block / nx % ny) * block_side,
          static_cast<int>(block / nx / ny) * block_side};
}

Vec3d ShellGrid::position(GridPoint p) const {
  return origin_ + spacing_ * Vec3d{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}

bool ShellGrid::contains(GridPoint p) const {
  return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < side_[0] * block_side && p.y < side_[1] * block_side &&
         p.z < side_[2] * block_side;
}

std::size_t ShellGrid::block_of(GridPoint p) const {
  const auto at = [](int i) { return static_cast<std::size_t>(i / block_side); };
  return (at(p.z) * static_cast<std::size_t>(side_[1]) + at(p.y)) * static_cast<std::size_t>(side_[0]) + at(p.x);
}

GridPoint ShellGrid::nearest_point(Vec3d p) const {
  const Vec3d g = (1 / spacing_) * (p - origin_);
  return {static_cast<int>(std::lround(g.x)), static_cast<int>(std::lround(g.y)), static_cast<int>(std::lround(g.z))};
}

bool ShellGrid::is_margin(GridPoint p) const {
  return p.x == 0 || p.y == 0 || p.z == 0 || p.x + 1 == side_[0] * block_side || p.y + 1 == side_[1] * block_side ||
         p.z + 1 == side_[2] * block_side;
}

// With the points that its edges lead to.
Box3f ShellGrid::box_of(std::size_t block) const {
  const GridPoint p = first_point(block);
  Box3f box;
  box.extend(to_float(position(p)));
  box.extend(to_float(position({p.x + block_side, p.y + block_side, p.z + block_side})));
  return box;
}

bool ShellGrid::is_uniform(std::size_t block) const {
  const GridPoint first = first_point(block);
  const std::uint64_t word = solid_[block][0];
  if (word != 0 && word != all_solid) return false;
  for (int k = 0; k < 8; ++k) {
    const GridPoint p{first.x + (k & 1 ? block_side : 0), first.y + (k & 2 ? block_side : 0),
                      first.z + (k & 4 ? block_side : 0)};
    if (!contains(p)) continue;
    const auto& words = solid_[block_of(p)];
    if (std::any_of(words.begin(), words.end(), [&](std::uint64_t w) { return w != word; })) return false;
  }
  return true;
}

const SheetPoint* ShellGrid::sheet_at(GridPoint p) const {
  const std::uint64_t wanted = number(p);
  const auto at = std::lower_bound(sheets_.begin(), sheets_.end(), wanted,
                                   [](const SheetPoint& s, std::uint64_t n) { return s.point < n; });
  return at != sheets_.end() && at->point == wanted ? &*at : nullptr;
}

void ShellGrid::views_of(std::size_t block, std::vector<ViewNumber>& views) const {
  if (space_.classify(box_of(block), views) == FreeSpace::State::mixed) return;
  views.resize(space_.maps().size());
  std::iota(views.begin(), views.end(), ViewNumber{0});
}

void ShellGrid::carve(std::size_t block) {
  std::vector<ViewNumber> views;
  const FreeSpace::State state = space_.classify(box_of(block), views);
  solid_[block].fill(0);
  if (state == FreeSpace::State::free) return;
  for (std::size_t place = 0; place < block_points; ++place) {
    const GridPoint p = point_at(block, place);
    if (is_margin(p) || (state == FreeSpace::State::mixed && space_.distance(position(p), views) > 0)) continue;
    make_solid(block, place);
  }
}

std::optional<GridPoint> ShellGrid::sheet_point(const PositionMap& map, std::size_t pixel) const {
  const Vec3d sample = to_double(map.position[pixel]);
  Vec3d inward = to_double(map.normal[pixel]);
  if (dot(inward, towards_eye(map.view, sample)) > 0) inward = -1.0 * inward;
  for (const double depth : {0.25, 0.5, 0.75, 1.0}) {
    const GridPoint p = nearest_point(sample + depth * spacing_ * inward);
    if (!contains(p) || is_solid(p)) return std::nullopt;
  }
  // Beside a sharp edge the grid may miss the surface, too, but what is below a sample is solid there.
  const Vec3d below = sample + 1.05 * spacing_ * inward;
  std::vector<ViewNumber> views;
  views_of(block_of(nearest_point(below)), views);
  if (!(space_.distance(below, views) > 0.1 * spacing_)) return std::nullopt;
  const GridPoint p = nearest_point(sample + 0.4 * spacing_ * inward);
  return is_margin(p) ? std::nullopt : std::optional(p);
}

void ShellGrid::find_sheets(Scheduler& scheduler) {
  const std::span<const PositionMap> maps = space_.maps();
  std::vector<std::vector<SheetPoint>> found(maps.size());
  scheduler.for_chunks(maps.size(), 1, [&](ChunkRange range) {
    const PositionMap& map = maps[range.index];
    if (map.view.nearest > 0) return;
    map.groups().for_pixels(0, map.view.pixels(), [&](std::size_t i) {
      if (!map.sees(i) || space_.is_back(range.index, i)) return;
      if (const auto p = sheet_point(map, i))
        found[range.index].push_back({number(*p), static_cast<ViewNumber>(range.index), static_cast<std::uint32_t>(i)});
    });
  });
  for (const auto& own : found) sheets_.insert(sheets_.end(), own.begin(), own.end());
  std::stable_sort(sheets_.begin(), sheets_.end(),
                   [](const SheetPoint& a, const SheetPoint& b) { return a.point < b.point; });
  const auto last = std::unique(sheets_.begin(), sheets_.end(),
                                [](const SheetPoint& a, const SheetPoint& b) { return a.point == b.point; });
  sheets_.erase(last, sheets_.end());
  for (const SheetPoint& s : sheets_) make_solid(s.point / block_points, s.point % block_points);
}

}  // namespace lodestone
