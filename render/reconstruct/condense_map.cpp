#include "render/reconstruct/condense_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lodestone {
namespace {

struct Step {
  int dx, dy;
  float weight;  // the three kinds of edges of a pixel's triangles count alike, and there are four diagonals
};
constexpr std::array<Step, 8> steps{{{1, 0, 2}, {-1, 0, 2}, {0, 1, 2}, {0, -1, 2}, {1, 1, 1}, {-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}}};

class Condenser {
 public:
  Condenser(const PositionMap& fine, const CondenseConfig& config, CondensedMap& result)
      : fine_(fine), config_(config), result_(result) {}

  void pixel(int x, int y) const {
    const std::size_t i = index(result_.map, x, y), f = index(fine_, 2 * x, 2 * y);
    copy(f, i);
    result_.links[i] = static_cast<std::uint8_t>(
        (linked(2 * x, 2 * y, 1, 0) ? link_right : 0) | (linked(2 * x, 2 * y, 0, 1) ? link_down : 0) |
        (linked(2 * x, 2 * y, 1, 1) ? link_diagonal : 0) | (linked(2 * x + 2, 2 * y, -1, 1) ? link_across : 0));
    if (!fine_.sees(f)) return;
    result_.map.normal[i] = mean_normal(2 * x, 2 * y);
    move(i, 2 * x, 2 * y);
  }

 private:
  [[nodiscard]] static std::size_t index(const PositionMap& map, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(map.view.width) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < fine_.view.width && y < fine_.view.height; }

  void copy(std::size_t from, std::size_t to) const {
    PositionMap& map = result_.map;
    map.position[to] = fine_.position[from];
    map.triangle[to] = fine_.triangle[from];
    map.depth[to] = fine_.depth[from];
    map.normal[to] = fine_.normal[from];
    if (!map.uv.empty()) map.uv[to] = fine_.uv[from];
    if (!map.colour.empty()) map.colour[to] = fine_.colour[from];
  }

  // Whether the surface goes on from (x, y) over the finer pixel beside it to the next one of the result.
  [[nodiscard]] bool linked(int x, int y, int dx, int dy) const {
    if (!holds(x, y) || !holds(x + 2 * dx, y + 2 * dy)) return false;
    const std::size_t a = index(fine_, x, y), b = index(fine_, x + dx, y + dy), c = index(fine_, x + 2 * dx, y + 2 * dy);
    return fine_.sees(a) && fine_.sees(b) && fine_.sees(c) && are_connected(fine_, config_.connect, a, b, dx, dy) &&
           are_connected(fine_, config_.connect, b, c, dx, dy);
  }

  // Of the pixel and those around it that are not across a crease.
  [[nodiscard]] Vec3f mean_normal(int x, int y) const {
    const Vec3f own = fine_.normal[index(fine_, x, y)];
    Vec3f sum = 2.0f * own;
    for (const Step& s : steps) {
      if (!holds(x + s.dx, y + s.dy)) continue;
      const std::size_t i = index(fine_, x + s.dx, y + s.dy);
      if (fine_.sees(i) && dot(fine_.normal[i], own) > config_.crease_cosine) sum = sum + fine_.normal[i];
    }
    const float norm = length(sum);
    return norm > 0 ? (1 / norm) * sum : own;
  }

  void move(std::size_t i, int x, int y) const {
    const std::size_t own = index(fine_, x, y);
    float sum = 0, weight = 0;
    for (const Step& s : steps) {
      if (!linked(x, y, s.dx, s.dy)) continue;
      const std::size_t middle = index(fine_, x + s.dx, y + s.dy), end = index(fine_, x + 2 * s.dx, y + 2 * s.dy);
      if (dot(fine_.normal[own], fine_.normal[end]) < config_.crease_cosine) continue;
      sum += s.weight * (fine_.depth[middle] - 0.5f * (fine_.depth[own] + fine_.depth[end]));
      weight += s.weight;
    }
    if (weight == 0) return;
    const auto limit = config_.farthest * static_cast<float>(result_.map.view.spacing(fine_.depth[own]));
    const double change = std::clamp(sum / weight, -limit, limit);
    const Ray ray = ray_through(fine_.view, x + 0.5, y + 0.5);
    result_.map.position[i] = to_float(to_double(fine_.position[own]) + change * ray.direction);
    result_.map.depth[i] = static_cast<float>(fine_.depth[own] + change);
  }

  const PositionMap& fine_;
  const CondenseConfig& config_;
  CondensedMap& result_;
};

}  // namespace

MapView finer_view(const MapView& view) {
  MapView finer = view;
  finer.pixel = view.pixel / 2;
  finer.width = 2 * view.width - 1;
  finer.height = 2 * view.height - 1;
  return finer;
}

CondensedMap condensed_like(const PositionMap& fine, const MapView& view) {
  CondensedMap result;
  PositionMap& map = result.map;
  map.view = view;
  map.transform = fine.transform;
  const std::size_t n = view.pixels();
  map.position.resize(n), map.triangle.resize(n), map.depth.resize(n), map.normal.resize(n);
  map.uv.resize(fine.uv.empty() ? 0 : n), map.colour.resize(fine.colour.empty() ? 0 : n);
  result.links.resize(n);
  return result;
}

void condense_rows(const PositionMap& fine, const CondenseConfig& config, int first, int last, CondensedMap& result) {
  const Condenser condenser(fine, config, result);
  for (int y = first; y < last; ++y)
    for (int x = 0; x < result.map.view.width; ++x) condenser.pixel(x, y);
}

}  // namespace lodestone
