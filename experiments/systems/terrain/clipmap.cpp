#include "experiments/systems/terrain/clipmap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lodestone {
namespace {

constexpr double longest_leg = 3;         // tolerances
constexpr double height_of_grid = 0.4;    // a grid is left out from a viewer above this share of its side
constexpr double transition_share = 0.1;  // of the posts along a side
constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

double fraction(int at, int from, int to) { return to == from ? 0 : static_cast<double>(at - from) / (to - from); }

float between(double u, float from, float to) { return static_cast<float>((1 - u) * double{from} + u * double{to}); }

}  // namespace

// The next grid begins half a side away, with legs of twice the spacing: these are the longest on the screen.
ClipmapConfig clipmap_for(const HeightField& field, double reach) {
  const double squares = 4 * reach / longest_leg;
  const int most = 4 * std::max(field.columns(), field.rows());  // beyond that, the field is in the finest grid
  return {2 * std::clamp(static_cast<int>(std::ceil(std::min(squares, 1e6) / 2)), 7, most) + 1};
}

Clipmap::Clipmap(const HeightField& field, HeightField::Over viewer, const ClipmapConfig& config)
    : field_(field), viewer_(viewer), posts_(config.posts) {
  const double above = (viewer.height - field.height_at(viewer.column, viewer.row)) / field.spacing();
  int level = 0;
  while (height_of_grid * posts_ * std::ldexp(1.0, level) < above && !covers(grid_at(level))) ++level;
  for (;; ++level) {
    grids_.push_back(grid_at(level));
    if (covers(grids_.back())) return;
  }
}

// Its ends are posts of the next coarser grid, and its middle is less than two squares from the viewer.
Clipmap::Grid Clipmap::grid_at(int level) const {
  Grid grid;
  grid.spacing = 1 << level, grid.squares = posts_ - 1;
  const auto first = [&](double viewer) {
    const double coarse = 2.0 * grid.spacing;
    return static_cast<int>(coarse * std::round((viewer - 0.5 * grid.squares * grid.spacing) / coarse));
  };
  grid.first = {first(viewer_.column), first(viewer_.row)};
  return grid;
}

bool Clipmap::covers(const Grid& grid) const {
  return grid.contains({0, 0}) && grid.contains({field_.columns() - 1, field_.rows() - 1});
}

// 1 from little more than a square before the outer end on, 0 up to a tenth of the side before that.
float Clipmap::share(const Grid& grid, Post post) const {
  const double width = transition_share * posts_;
  const auto along = [&](double place, double viewer) {
    return (std::abs(place - viewer) / grid.spacing - (0.5 * grid.squares - width - 1.01)) / width;
  };
  return static_cast<float>(std::clamp(std::max(along(post.i, viewer_.column), along(post.j, viewer_.row)), 0.0, 1.0));
}

// On the triangles of the next coarser grid: along its edges, and its diagonals.
float Clipmap::coarse_height(const Grid& grid, Post post) const {
  const bool odd_i = post.i / grid.spacing % 2 != 0, odd_j = post.j / grid.spacing % 2 != 0;
  const int di = odd_i ? grid.spacing : 0, dj = odd_j ? grid.spacing : 0;
  const Post at = field_.clamped(post);
  const Post from = field_.clamped({post.i - di, post.j - dj}), to = field_.clamped({post.i + di, post.j + dj});
  const double u = odd_i ? fraction(at.i, from.i, to.i) : fraction(at.j, from.j, to.j);
  return between(u, field_.height(from), field_.height(to));
}

float Clipmap::height(const Grid& grid, Post post) const {
  const float own = field_.height(field_.clamped(post)), moved = share(grid, post);
  if (moved <= 0) return own;
  return between(moved, own, coarse_height(grid, post));
}

bool Clipmap::is_main(const Grid& grid, Post post) const { return grid.spacing > 1 || field_.has_main_diagonal(post); }

Clipmap::Mesh Clipmap::mesh() const {
  Mesh mesh;
  for (std::size_t g = 0; g < grids_.size(); ++g) add_grid(g, mesh);
  for (std::size_t g = 0; g + 1 < grids_.size(); ++g) close_junctions(grids_[g], mesh);
  return mesh;
}

// Without the squares that the finer grid has, and those beyond the field. In strips of 16 by 16 squares, so that
// triangles side by side are near each other.
void Clipmap::add_grid(std::size_t number, Mesh& mesh) const {
  const Grid& grid = grids_[number];
  const Grid* const finer = number > 0 ? &grids_[number - 1] : nullptr;
  const int s = grid.spacing, strip = 16 * s;
  const int begin_i = std::max(grid.first.i, 0), end_i = std::min(grid.end_i(), field_.columns() - 1);
  const int begin_j = std::max(grid.first.j, 0), end_j = std::min(grid.end_j(), field_.rows() - 1);
  if (begin_i >= end_i || begin_j >= end_j) return;
  const int across = (end_i - begin_i + s - 1) / s + 1, along = (end_j - begin_j + s - 1) / s + 1;
  std::vector<std::uint32_t> vertex(static_cast<std::size_t>(across) * static_cast<std::size_t>(along), none);
  const auto vertex_at = [&](Post p) {
    std::uint32_t& v = vertex[static_cast<std::size_t>((p.j - begin_j) / s * across + (p.i - begin_i) / s)];
    if (v != none) return v;
    v = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(field_.place(field_.clamped(p), height(grid, p)));
    mesh.normals.push_back(field_.normal(field_.clamped(p)));
    return v;
  };
  const auto add_square = [&](Post a) {
    if (finer && finer->contains(a) && finer->contains({a.i + s, a.j + s})) return;
    const std::array<std::uint32_t, 4> v{vertex_at(a), vertex_at({a.i + s, a.j}), vertex_at({a.i + s, a.j + s}),
                                         vertex_at({a.i, a.j + s})};
    const bool main = is_main(grid, a);
    mesh.triangles.push_back(field_.facing({{v[0], v[1], v[main ? 2 : 3]}}));
    mesh.triangles.push_back(field_.facing({{v[main ? 0 : 1], v[2], v[3]}}));
  };
  for (int j0 = begin_j; j0 < end_j; j0 += strip)
    for (int i0 = begin_i; i0 < end_i; i0 += strip)
      for (int j = j0; j < std::min(j0 + strip, end_j); j += s)
        for (int i = i0; i < std::min(i0 + strip, end_i); i += s) add_square({i, j});
}

// Around a grid, counter-clockwise: a triangle from both ends of each edge of the coarser grid to the post between
// them.
void Clipmap::close_junctions(const Grid& inner, Mesh& mesh) const {
  const int s = inner.spacing;
  const auto add = [&](Post from, Post by, Post to) {
    const Post a = field_.clamped(from), b = field_.clamped(by), c = field_.clamped(to);
    if (a == b || b == c) return;  // beyond an end of the field, where there is no junction
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Post p : {from, by, to}) {
      mesh.positions.push_back(field_.place(field_.clamped(p), height(inner, p)));
      mesh.normals.push_back(field_.normal(field_.clamped(p)));
    }
    mesh.triangles.push_back(field_.facing({{first, first + 2, first + 1}}));
  };
  for (int k = 0; k < inner.squares; k += 2) {
    const int i = inner.first.i + k * s, j = inner.first.j + k * s;
    const int low = inner.first.j, high = inner.end_j(), left = inner.first.i, right = inner.end_i();
    if (low > 0 && low < field_.rows() - 1) add({i, low}, {i + s, low}, {i + 2 * s, low});
    if (right > 0 && right < field_.columns() - 1) add({right, j}, {right, j + s}, {right, j + 2 * s});
    if (high > 0 && high < field_.rows() - 1) add({i + 2 * s, high}, {i + s, high}, {i, high});
    if (left > 0 && left < field_.columns() - 1) add({left, j + 2 * s}, {left, j + s}, {left, j});
  }
}

float Clipmap::height_over(Post post) const {
  const auto at = std::ranges::find_if(grids_, [&](const Grid& grid) { return grid.contains(post); });
  const Grid& grid = at == grids_.end() ? grids_.back() : *at;
  const int s = grid.spacing;
  const auto down = [&](int place, int first) { return first + (place - first) / s * s; };
  const Post a{down(post.i, grid.first.i), down(post.j, grid.first.j)};
  if (a == post) return height(grid, post);
  const Post c{a.i + s, a.j + s}, low = field_.clamped(a), high = field_.clamped(c);
  const double u = fraction(post.i, low.i, high.i), v = fraction(post.j, low.j, high.j);
  const double first = height(grid, a), last = height(grid, c);  // coarse squares have main diagonals
  const double turn = u >= v ? height(grid, {c.i, a.j}) : height(grid, {a.i, c.j});
  const double most = std::max(u, v), least = std::min(u, v);
  return static_cast<float>((1 - most) * first + (most - least) * turn + least * last);
}

}  // namespace lodestone
