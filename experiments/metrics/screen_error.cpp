#include "experiments/metrics/screen_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace lodestone {
namespace {

struct Soup {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;

  void add(std::span<const Vec3f> from, std::span<const Triangle> of_cell) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const Vec3f p : from) positions.push_back(to_double(p));
    for (const Triangle& t : of_cell) triangles.push_back({{first + t.v[0], first + t.v[1], first + t.v[2]}});
  }
};

Soup finest_soup(const Hierarchy& hierarchy) {
  Soup soup;
  for (const Cell& cell : hierarchy.cells_of(hierarchy.finest())) soup.add(cell.positions, cell.triangles);
  return soup;
}

// The triangles of all selected cells, culled or not: what is just outside may be the nearest of what is inside.
Soup drawn_soup(const MorphContext& morph, const Selection& selection) {
  Soup soup;
  std::vector<Vec3f> morphed;
  for (const SelectedCell& s : selection.cells) {
    const Cell& cell = morph.hierarchy->cells[s.cell];
    morphed.resize(cell.positions.size());
    morph_cell(morph, s.cell, morphed);
    soup.add(morphed, cell.triangles);
  }
  return soup;
}

class Screen {
 public:
  Screen(const ViewProjection& view_projection, ImageSize size)
      : m_(view_projection), half_width_(0.5 * size.width), half_height_(0.5 * size.height) {}

  struct Place {
    double x = 0, y = 0;
    bool inside = false;
  };
  // In pixels from the centre; nothing behind the near plane.
  [[nodiscard]] std::optional<Place> project(Vec3d p) const {
    std::array<double, 4> clip{};
    for (std::size_t row = 0; row < 4; ++row)
      clip[row] = m_.m[4 * row] * p.x + m_.m[4 * row + 1] * p.y + m_.m[4 * row + 2] * p.z + m_.m[4 * row + 3];
    const auto [x, y, z, w] = clip;
    if (!(w > 0) || z < -w) return std::nullopt;
    return Place{x / w * half_width_, y / w * half_height_, std::abs(x) <= w && std::abs(y) <= w && z <= w};
  }

 private:
  const ViewProjection& m_;
  double half_width_, half_height_;
};

struct Farthest {
  double pixels = 0;
  std::uint64_t points = 0;
};

// Of `count` points inside the picture, how far the nearest one of `other` is on the screen at most.
template <class PointOf>
Farthest farthest(std::size_t count, const PointOf& point_of, const TriangleBvh& other, const Screen& screen,
                  Scheduler& scheduler) {
  constexpr std::size_t grain = 4096;
  std::vector<Farthest> partial(chunk_count(count, grain));
  scheduler.for_chunks(count, grain, [&](ChunkRange range) {
    Farthest& own = partial[range.index];
    std::uint32_t hint = TriangleBvh::no_hint;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const Vec3d p = point_of(i);
      const auto from = screen.project(p);
      if (!from || !from->inside) continue;
      const TriangleBvh::Nearest nearest = other.nearest(p, hint);
      hint = nearest.slot;
      ++own.points;
      if (const auto to = screen.project(nearest.point))
        own.pixels = std::max(own.pixels, std::hypot(to->x - from->x, to->y - from->y));
    }
  });
  Farthest all;
  for (const Farthest& f : partial) all = {std::max(all.pixels, f.pixels), all.points + f.points};
  return all;
}

TriangleBvh bvh_of(const Soup& soup) { return TriangleBvh(soup.positions, soup.triangles); }

}  // namespace

ScreenErrorBasis::ScreenErrorBasis(const Hierarchy& hierarchy) : full_(bvh_of(finest_soup(hierarchy))) {}

ScreenError screen_error(const MorphContext& morph, const Selection& selection, const ViewProjection& view_projection,
                         ImageSize size, const ScreenErrorBasis& basis, Scheduler& scheduler) {
  const Screen screen(view_projection, size);
  const Soup drawn = drawn_soup(morph, selection);
  ScreenError error;
  if (drawn.triangles.empty()) return error;
  const std::size_t vertices = drawn.positions.size();
  const auto drawn_point = [&](std::size_t i) {
    if (i < vertices) return drawn.positions[i];
    const Triangle& t = drawn.triangles[i - vertices];
    return (1.0 / 3) * (drawn.positions[t.v[0]] + drawn.positions[t.v[1]] + drawn.positions[t.v[2]]);
  };
  const Farthest there = farthest(vertices + drawn.triangles.size(), drawn_point, basis.full(), screen, scheduler);
  const TriangleBvh drawn_bvh = bvh_of(drawn);
  error.drawn_to_full = there.pixels;
  error.points = there.points;
  for (const Cell& cell : morph.hierarchy->cells_of(morph.hierarchy->finest())) {
    const Farthest back = farthest(
        cell.positions.size(), [&](std::size_t i) { return to_double(cell.positions[i]); }, drawn_bvh, screen,
        scheduler);
    error.full_to_drawn = std::max(error.full_to_drawn, back.pixels);
    error.points += back.points;
  }
  return error;
}

}  // namespace lodestone
