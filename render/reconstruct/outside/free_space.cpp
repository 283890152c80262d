#include "render/reconstruct/outside/free_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/position_map/map_view.h"

namespace lodestone {
namespace {

constexpr float infinitely_far = std::numeric_limits<float>::infinity();
constexpr int base_side = 4;  // pixels of a square of level 0

// A plane seen from its edge says nothing about what lies farther than this from the sample, along the view.
constexpr double plane_pixels = 3;
constexpr double most_backs = 0.1;  // share of all pixels that see the back of a solid through its holes
// Places are cubes of this number along the model's longest side. Where more than this share of the pixels that show a
// place see its back, a part is inside out.
constexpr int places = 64;
constexpr double inside_out = 2.0 / 3;

std::size_t place_of(Vec3f p) {
  const auto digit = [](float x) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(x * places), 0, places - 1));
  };
  return (digit(p.z) * places + digit(p.y)) * places + digit(p.x);
}

bool is_seen_from_behind(const PositionMap& map, std::size_t pixel) {
  return dot(to_double(map.normal[pixel]), towards_eye(map.view, to_double(map.position[pixel]))) < 0;
}

std::size_t index_of(const PositionMap& map, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(map.view.width) + static_cast<std::size_t>(x);
}

}  // namespace

struct FreeSpace::Footprint {
  double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300, near = 1e300, far = -1e300;
};

FreeSpace::FreeSpace(std::span<const PositionMap> maps, double reach, Scheduler& scheduler)
    : maps_(maps), reach_(reach), levels_(maps.size()) {
  find_backs(scheduler);
  find_holes(scheduler);
  scheduler.for_chunks(maps.size(), 1, [&](ChunkRange range) {
    if (!(maps_[range.index].view.nearest > 0)) make_levels(range.index);
  });
}

void FreeSpace::find_backs(Scheduler& scheduler) {
  sides_.resize(maps_.size());
  scheduler.for_chunks(maps_.size(), 1, [&](ChunkRange range) {
    const PositionMap& map = maps_[range.index];
    PixelArray<Side>& sides = sides_[range.index];
    sides = map.triangle.like(Side::front);
    map.groups().for_pixels(0, map.view.pixels(), [&](std::size_t i) {
      if (map.sees(i) && is_seen_from_behind(map, i)) sides[i] = Side::back;
    });
  });
}

void FreeSpace::find_holes(Scheduler& scheduler) {
  std::vector<std::array<std::uint32_t, 2>> pixels(std::size_t{places} * places * places);  // fronts, backs
  for (std::size_t v = 0; v < maps_.size(); ++v)
    maps_[v].groups().for_pixels(0, maps_[v].view.pixels(), [&](std::size_t i) {
      if (maps_[v].sees(i)) ++pixels[place_of(maps_[v].position[i])][sides_[v][i] == Side::back];
    });
  std::array<double, 2> sum{};
  for (const auto& own : pixels) sum[0] += own[0], sum[1] += own[1];
  if (sum[1] >= most_backs * (sum[0] + sum[1])) return;
  scheduler.for_chunks(maps_.size(), 1, [&](ChunkRange range) {
    const PositionMap& map = maps_[range.index];
    map.groups().for_pixels(0, map.view.pixels(), [&](std::size_t i) {
      if (sides_[range.index][i] != Side::back) return;
      const auto [fronts, backs] = pixels[place_of(map.position[i])];
      if (backs <= inside_out * (static_cast<double>(fronts) + backs)) sides_[range.index][i] = Side::back_through_hole;
    });
  });
}

// Squares of `side` by `side` depths of a picture, which are infinite where it has no memory.
template <class DepthsAt>
FreeSpace::Level FreeSpace::coarser(int width, int height, const PixelGroups& groups, int side,
                                    const DepthsAt& depths_at) {
  const auto row = static_cast<std::size_t>(width);
  Level level{(width + side - 1) / side, (height + side - 1) / side, {}};
  PixelMarks marks(level.width, level.height);
  for (int y = 0; y < height; ++y) {
    const std::size_t begin = static_cast<std::size_t>(y) * row;
    const auto mark = [&](std::size_t first, std::size_t last) {
      marks.add(static_cast<int>(first - begin) / side, static_cast<int>(last - begin - 1) / side + 1, y / side);
    };
    groups.for_runs(begin, begin + row, mark, [](std::size_t, std::size_t) {});
  }
  level.depths = PixelArray(marks.groups(), Range{infinitely_far, infinitely_far});
  level.depths.groups().for_pixels(0, level.depths.size(), [&](std::size_t square) {
    const int x0 = static_cast<int>(square % static_cast<std::size_t>(level.width)) * side,
              y0 = static_cast<int>(square / static_cast<std::size_t>(level.width)) * side;
    Range range{infinitely_far, 0};
    for (int y = y0; y < std::min(y0 + side, height); ++y)
      for (int x = x0; x < std::min(x0 + side, width); ++x) {
        const Range own = depths_at(static_cast<std::size_t>(y) * row + static_cast<std::size_t>(x));
        range = {std::min(range.least, own.least), std::max(range.largest, own.largest)};
      }
    level.depths[square] = range;
  });
  return level;
}

void FreeSpace::make_levels(std::size_t view) {
  const PositionMap& map = maps_[view];
  std::vector<Level>& levels = levels_[view];
  levels.push_back(coarser(map.view.width, map.view.height, map.groups(), base_side, [&](std::size_t i) {
    const float depth = !map.sees(i) ? infinitely_far : is_back(view, i) ? 0.0f : map.depth[i];
    return Range{depth, depth};
  }));
  while (levels.back().width > 1 || levels.back().height > 1) {
    const Level& fine = levels.back();
    levels.push_back(
        coarser(fine.width, fine.height, fine.depths.groups(), 2, [&](std::size_t i) { return fine.depths[i]; }));
  }
}

FreeSpace::Footprint FreeSpace::footprint(const MapView& view, const Box3f& box) const {
  Footprint print;
  for (unsigned k = 0; k < 8; ++k) {
    const WindowPoint w = to_window(
        view, to_double(Vec3f{k & 1 ? box.hi.x : box.lo.x, k & 2 ? box.hi.y : box.lo.y, k & 4 ? box.hi.z : box.lo.z}));
    print.x0 = std::min(print.x0, w.x), print.x1 = std::max(print.x1, w.x);
    print.y0 = std::min(print.y0, w.y), print.y1 = std::max(print.y1, w.y);
    print.near = std::min(print.near, w.depth), print.far = std::max(print.far, w.depth);
  }
  // The four pixels around a point.
  print.x0 -= 1, print.x1 += 1, print.y0 -= 1, print.y1 += 1;
  return print;
}

FreeSpace::Range FreeSpace::depths_in(std::size_t view, const Footprint& print) const {
  const MapView& window = maps_[view].view;
  Range range{infinitely_far, 0};
  const double x0 = std::max(print.x0, 0.0), x1 = std::min(print.x1, window.width - 1e-9), y0 = std::max(print.y0, 0.0),
               y1 = std::min(print.y1, window.height - 1e-9);
  if (print.x0 < 0 || print.y0 < 0 || print.x1 > window.width || print.y1 > window.height)
    range.largest = infinitely_far;  // some of it is beside the map
  if (x0 > x1 || y0 > y1) return range;
  // Squares so large that at most 3 x 3 of them matter.
  std::size_t k = 0;
  double side = base_side;
  while (k + 1 < levels_[view].size() && std::max(x1 - x0, y1 - y0) > 2 * side) ++k, side *= 2;
  const Level& level = levels_[view][k];
  for (int y = static_cast<int>(y0 / side); y <= static_cast<int>(y1 / side); ++y)
    for (int x = static_cast<int>(x0 / side); x <= static_cast<int>(x1 / side); ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) + static_cast<std::size_t>(x);
      range.least = std::min(range.least, level.depths[i].least);
      range.largest = std::max(range.largest, level.depths[i].largest);
    }
  return range;
}

FreeSpace::State FreeSpace::classify(const Box3f& box, std::vector<ViewNumber>& views) const {
  views.clear();
  for (std::size_t v = 0; v < maps_.size(); ++v) {
    if (levels_[v].empty()) continue;
    const Footprint print = footprint(maps_[v].view, box);
    const Range depths = depths_in(v, print);
    // As in distance_in(), for all points of the box at once.
    const MapView& view = maps_[v].view;
    const double near = reach_ + plane_pixels * view.spacing(print.near),
                 far = reach_ + plane_pixels * view.spacing(print.far);
    if (print.far + far < double{depths.least}) return State::free;
    if (print.near - near <= double{depths.largest}) views.push_back(static_cast<ViewNumber>(v));
  }
  return views.empty() ? State::solid : State::mixed;
}

double FreeSpace::distance_in(std::size_t view, Vec3d p) const {
  const PositionMap& map = maps_[view];
  const WindowPoint w = to_window(map.view, p);
  const double fx = std::floor(w.x - 0.5), fy = std::floor(w.y - 0.5);
  if (fx < -1 || fy < -1 || fx >= map.view.width || fy >= map.view.height) return reach_;
  const int x0 = static_cast<int>(fx), y0 = static_cast<int>(fy);
  const double farthest = plane_pixels * map.view.spacing(w.depth);
  double least = reach_;
  for (int y = std::max(y0, 0); y <= std::min(y0 + 1, map.view.height - 1); ++y)
    for (int x = std::max(x0, 0); x <= std::min(x0 + 1, map.view.width - 1); ++x) {
      const std::size_t i = index_of(map, x, y);
      if (!map.sees(i)) continue;
      if (is_back(view, i)) return -reach_;
      const double before = double{map.depth[i]} - w.depth;
      if (before > reach_ + farthest) continue;
      if (before < -reach_ - farthest) return -reach_;
      const Vec3f n = normal_towards_eye(view, i);
      const bool plane = n.x != 0 || n.y != 0 || n.z != 0;
      const double off = plane ? dot(p - to_double(map.position[i]), to_double(n)) : before;
      least = std::min({least, off, before + farthest});
    }
  return std::max(least, -reach_);
}

double FreeSpace::distance(Vec3d p, std::span<const ViewNumber> views) const {
  double best = -reach_;
  for (const ViewNumber v : views) {
    best = std::max(best, distance_in(v, p));
    if (best >= reach_) break;
  }
  return best;
}

SurfaceHit FreeSpace::nearest(Vec3d p, std::span<const ViewNumber> views) const {
  SurfaceHit best;
  double least = 1e300;
  for (const ViewNumber v : views) {
    const PositionMap& map = maps_[v];
    const WindowPoint w = to_window(map.view, p);
    if (!(w.x >= 0) || !(w.y >= 0) || !(w.x < map.view.width) || !(w.y < map.view.height)) continue;
    const std::size_t i = index_of(map, static_cast<int>(w.x), static_cast<int>(w.y));
    if (!map.sees(i) || is_back(v, i)) continue;
    const Vec3d away = p - to_double(map.position[i]);
    if (dot(away, away) > reach_ * reach_) continue;
    const Vec3f n = normal_towards_eye(v, i);
    const double facing = dot(to_double(n), towards_eye(map.view, p)), off = dot(away, to_double(n));
    if (!(facing > 0)) continue;
    // The plane that passes nearest, and of those the one that its view samples most densely.
    const double cost = std::abs(off) / reach_ + 0.5 * (1 - facing) + 0.1 * length(away) / reach_;
    if (cost < least) least = cost, best = {v, static_cast<std::uint32_t>(i), n, off};
  }
  return best;
}

}  // namespace lodestone
