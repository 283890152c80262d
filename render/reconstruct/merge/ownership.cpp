#include "render/reconstruct/merge/ownership.h"

#include <algorithm>
#include <cmath>

#include "render/position_map/map_view.h"
#include "render/reconstruct/views/cell_corners.h"

namespace lodestone {
namespace {

// Weight of the view besides its samples: enough to outvote the noise of a tie.
float rank_factor(std::size_t number) {
  const auto k = static_cast<float>(number);
  return 1 - 0.02f * std::min(k, 8.0f) - 0.002f * std::clamp(k - 8, 0.0f, 50.0f);
}

bool has_two(std::uint8_t cell) {
  const unsigned bits = cell & cell_triangles;
  return (bits & (bits - 1)) != 0;
}

// True if triangles surround a pixel.
bool is_inside(const PixelArray<std::uint8_t>& cells, std::size_t i, std::size_t width) {
  return i > width && has_two(cells[i]) && has_two(cells[i - 1]) && has_two(cells[i - width]) &&
         has_two(cells[i - width - 1]);
}

// The weights of the corners p, q, r, s of a cell at (u, v) in [0, 1]^2; false if no triangle contains it.
bool weights_in_cell(std::uint8_t cell, float u, float v, float (&w)[4]) {
  if (cell & (cell_prs | cell_psq)) {
    if (v > u ? !(cell & cell_prs) : !(cell & cell_psq)) return false;
    w[0] = 1 - std::max(u, v), w[3] = std::min(u, v);
    w[1] = std::max(u - v, 0.0f), w[2] = std::max(v - u, 0.0f);
    return true;
  }
  const bool upper = u + v < 1;
  if (upper ? !(cell & cell_prq) : !(cell & cell_rsq)) return false;
  w[0] = upper ? 1 - u - v : 0, w[3] = upper ? 0 : u + v - 1;
  w[1] = upper ? u : 1 - v, w[2] = upper ? v : 1 - u;
  return true;
}

ViewNumber owner_of(std::span<const MergeView> views, std::size_t number, std::size_t i,
                    const OwnershipConfig& config) {
  const PositionMap& map = *views[number].map;
  float best = views[number].score[i] * rank_factor(number);
  std::size_t owner = number;
  for (std::size_t other = 0; other < views.size(); ++other) {
    if (other == number) continue;
    const float there = score_at(views[other], map, i, config, best / rank_factor(other));
    if (there < 0 || !(there * rank_factor(other) > best)) continue;
    best = there * rank_factor(other);
    owner = other;
  }
  return static_cast<ViewNumber>(owner);
}

}  // namespace

void score_rows(const MergeView& view, const OwnershipConfig& config, int first, int last, PixelArray<float>& score) {
  const PositionMap& map = *view.map;
  const auto width = static_cast<std::size_t>(map.view.width);
  for_pixels(view, first, last, [&](std::size_t i) {
    score[i] = 0;
    if (!map.sees(i)) return;
    const Vec3d p = to_double(map.position[i]);
    const double facing = dot(to_double(map.normal[i]), towards_eye(map.view, p));
    const double relative = map.view.spacing(map.view.depth(p)) / config.reference_spacing;
    // The inside of an open surface is seen as well as its outside; it is used where no view sees the outside.
    const double side = facing < 0 ? 0.5 : 1;
    const bool is_whole =
        is_inside(view.mesh.cells, i, width) || (config.border != nullptr && config.border->is_near(map.position[i]));
    const double border = is_whole ? 1 : 0.02;
    score[i] = static_cast<float>(border * side * std::max(std::abs(facing), 0.02) / (relative * relative));
  });
}

void spread_rows(const MergeView& view, int first, int last, const PixelArray<float>& from, PixelArray<float>& to) {
  const std::size_t width = static_cast<std::size_t>(view.map->view.width),
                    height = static_cast<std::size_t>(view.map->view.height);
  const PixelArray<std::uint8_t>& cells = view.mesh.cells;
  for (int y = first; y < last; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * width;
    for_pixels(view, y, y + 1, [&](std::size_t i) {
      const std::size_t x = i - row;
      float sum = 2 * from[i], weight = 2;
      const auto add = [&](bool connected, std::size_t other) {
        sum += connected ? from[other] : 0, weight += connected ? 1.0f : 0.0f;
      };
      const std::uint8_t here = cells[i], above = y > 0 ? cells[i - width] : 0, before = x > 0 ? cells[i - 1] : 0;
      add((here & (cell_psq | cell_prq)) || (above & (cell_prs | cell_rsq)), std::min(i + 1, width * height - 1));
      add((here & (cell_prs | cell_prq)) || (before & (cell_psq | cell_rsq)), std::min(i + width, width * height - 1));
      if (x > 0)
        add((before & (cell_psq | cell_prq)) || (y > 0 && (cells[i - width - 1] & (cell_prs | cell_rsq))), i - 1);
      if (y > 0)
        add((above & (cell_prs | cell_prq)) || (x > 0 && (cells[i - width - 1] & (cell_psq | cell_rsq))), i - width);
      to[i] = sum / weight;
    });
  }
}

float score_at(const MergeView& view, const PositionMap& from, std::size_t pixel, const OwnershipConfig& config,
               float least) {
  const PositionMap& map = *view.map;
  const Vec3f point = from.position[pixel];
  const WindowPoint w = to_window(map.view, to_double(point));
  const double fx = w.x - 0.5, fy = w.y - 0.5;
  if (!(fx >= 0) || !(fy >= 0) || fx >= map.view.width - 1 || fy >= map.view.height - 1) return -1;
  const auto x = static_cast<std::size_t>(fx), y = static_cast<std::size_t>(fy);
  const auto width = static_cast<std::size_t>(map.view.width);
  const std::size_t p = y * width + x, corner[4]{p, p + 1, p + width, p + width + 1};
  const std::uint8_t cell = view.mesh.cells[p];
  float weight[4];
  if (cell == 0 || !weights_in_cell(cell, static_cast<float>(fx - static_cast<double>(x)),
                                    static_cast<float>(fy - static_cast<double>(y)), weight))
    return -1;
  float depth = 0, score = 0, lowest = 1;
  for (std::size_t k = 0; k < 4; ++k) {
    if (weight[k] == 0) continue;
    depth += weight[k] * map.depth[corner[k]];
    score += weight[k] * view.score[corner[k]];
    lowest = std::min(lowest, view.score[corner[k]]);
  }
  // Off the surface by so much, measured across it; where it is steep the depth says little. Most points are beaten, or
  // far behind what this view sees, and need not be looked at more closely.
  constexpr float steepest = 0.2f;
  const float behind = std::abs(static_cast<float>(w.depth) - depth),
              most = static_cast<float>(config.reference_spacing);
  if (lowest < 0 || !(score > least) || behind * steepest > most) return -1;
  Vec3f mean;
  for (std::size_t k = 0; k < 4; ++k)
    if (weight[k] != 0) mean = mean + weight[k] * map.normal[corner[k]];
  if (dot(mean, from.normal[pixel]) < 0) return -1;
  if (!config.parts.empty()) {
    // All corners of a triangle are of one part.
    const std::size_t any =
        *std::find_if(corner, corner + 4, [&](const std::size_t& c) { return weight[&c - corner] > 0; });
    if (config.parts[map.triangle[any]] != config.parts[from.triangle[pixel]]) return -1;
  }
  const Vec3f eye = to_float(towards_eye(map.view, to_double(point)));
  if (behind * std::max(std::abs(dot(mean, eye)), steepest) > most) return -1;
  return score;
}

void own_rows(std::span<MergeView> views, std::size_t number, const OwnershipConfig& config, int first, int last) {
  MergeView& view = views[number];
  for_pixels(view, first, last,
             [&](std::size_t i) { view.owner[i] = view.map->sees(i) ? owner_of(views, number, i, config) : no_view; });
}

void own_dropped_rows(std::span<MergeView> views, std::size_t number, const OwnershipConfig& config, int first,
                      int last) {
  MergeView& view = views[number];
  const PositionMap& map = *view.map;
  for_pixels(view, first, last, [&](std::size_t i) {
    const ViewNumber owner = view.owner[i];
    if (owner == no_view) return;
    const float score = owner == number ? view.score[i] : score_at(views[owner], map, i, config);
    if (score < 0) view.owner[i] = owner_of(views, number, i, config);
  });
}

void keep_rows(MergeView& view, std::size_t number, int first, int last) {
  const auto width = static_cast<std::size_t>(view.map->view.width);
  const auto own = [&](std::size_t i) { return view.owner[i] == number; };
  for_pixels(view, first, last, [&](std::size_t i) {
    const std::uint8_t cell = view.mesh.cells[i];
    view.kept[i] = 0;
    if (cell == 0) return;
    const bool p = own(i), q = own(i + 1), r = own(i + width), s = own(i + width + 1);
    unsigned lost = 0;
    if (!(p && r && s)) lost |= cell_prs;
    if (!(p && s && q)) lost |= cell_psq;
    if (!(p && r && q)) lost |= cell_prq;
    if (!(r && s && q)) lost |= cell_rsq;
    const unsigned left = cell & ~lost;
    view.kept[i] = left & cell_triangles ? static_cast<std::uint8_t>(left) : std::uint8_t{0};
  });
}

std::size_t drop_lone_rows(MergeView& view, std::size_t number, int first, int last) {
  const auto width = static_cast<std::size_t>(view.map->view.width);
  std::size_t dropped = 0;
  for_pixels(view, first, last, [&](std::size_t i) {
    if (view.owner[i] != number || is_vertex(cells_around(view.kept, i, width))) return;
    view.score[i] = -1;
    ++dropped;
  });
  return dropped;
}

}  // namespace lodestone
