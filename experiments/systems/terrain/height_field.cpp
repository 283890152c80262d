#include "experiments/systems/terrain/height_field.h"

#include <cmath>
#include <string>

#include "core/base/error.h"
#include "core/base/sort_unique.h"

namespace lodestone {
namespace {

float coordinate(Vec3f p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

std::vector<float> distinct(const std::vector<Vec3f>& positions, int axis) {
  std::vector<float> values;
  for (const Vec3f p : positions) values.push_back(coordinate(p, axis));
  sort_unique(values);
  return values;
}

int place_of(const std::vector<float>& ascending, float value) {
  return static_cast<int>(std::ranges::lower_bound(ascending, value) - ascending.begin());
}

// Fraction of the grid, as if it went on with the mean spacing.
double fraction(const std::vector<float>& posts, double value) {
  if (value <= posts.front() || value >= posts.back()) {
    const double spacing = (double{posts.back()} - posts.front()) / static_cast<double>(posts.size() - 1);
    return (value - posts.front()) / spacing;
  }
  const auto after = std::ranges::upper_bound(posts, static_cast<float>(value));
  const auto at = std::min<std::ptrdiff_t>(after - posts.begin(), static_cast<std::ptrdiff_t>(posts.size()) - 1) - 1;
  const double from = posts[static_cast<std::size_t>(at)], to = posts[static_cast<std::size_t>(at) + 1];
  return static_cast<double>(at) + (value - from) / (to - from);
}

}  // namespace

HeightField::HeightField(const WeldedSurface& surface, std::string_view system) {
  for (const std::array<int, 3> axes : {std::array{0, 1, 2}, {0, 2, 1}, {1, 2, 0}})
    if (try_axes(surface, axes)) return;
  throw InputError("the system " + std::string(system) +
                   " draws height fields alone; give it a grid of heights without voids, such as a terrain");
}

bool HeightField::try_axes(const WeldedSurface& surface, std::array<int, 3> axes) {
  axes_ = axes;
  across_ = distinct(surface.positions, axes[0]), along_ = distinct(surface.positions, axes[1]);
  const std::size_t count = surface.positions.size();
  if (across_.size() < 2 || along_.size() < 2 || across_.size() * along_.size() != count) return false;
  if (surface.triangles.size() != 2 * (across_.size() - 1) * (along_.size() - 1)) return false;

  std::vector<Post> posts;
  heights_.assign(count, 0), normals_.assign(count, {});
  std::vector<std::uint8_t> found(count, 0);
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3f p = surface.positions[v];
    posts.push_back({place_of(across_, coordinate(p, axes[0])), place_of(along_, coordinate(p, axes[1]))});
    const std::size_t at = index(posts.back());
    if (found[at]) return false;
    found[at] = 1, heights_[at] = coordinate(p, axes[2]), normals_[at] = surface.normals[v];
  }
  main_diagonal_.assign(count, 0);
  for (const auto& [v] : surface.triangles) {
    const Post a = posts[v[0]], b = posts[v[1]], c = posts[v[2]];
    const auto [left, right] = std::minmax({a.i, b.i, c.i});
    const auto [low, high] = std::minmax({a.j, b.j, c.j});
    if (right - left != 1 || high - low != 1) return false;
    const auto has = [&](Post p) { return a == p || b == p || c == p; };
    if (has({left, low}) && has({right, high})) main_diagonal_[index({left, low})] = 1;
    mirrored_ = (b.i - a.i) * (c.j - a.j) - (b.j - a.j) * (c.i - a.i) < 0;
  }
  return true;
}

Vec3f HeightField::place(Post p, float height) const {
  std::array<float, 3> at{};
  at[static_cast<std::size_t>(axes_[0])] = across_[static_cast<std::size_t>(p.i)];
  at[static_cast<std::size_t>(axes_[1])] = along_[static_cast<std::size_t>(p.j)];
  at[static_cast<std::size_t>(axes_[2])] = height;
  return {at[0], at[1], at[2]};
}

HeightField::Over HeightField::over(Vec3f place) const {
  return {fraction(across_, coordinate(place, axes_[0])), fraction(along_, coordinate(place, axes_[1])),
          coordinate(place, axes_[2])};
}

double HeightField::spacing() const {
  return 0.5 * ((double{across_.back()} - across_.front()) / (columns() - 1) +
                (double{along_.back()} - along_.front()) / (rows() - 1));
}

double HeightField::height_at(double column, double row) const {
  const double x = std::clamp(column, 0.0, columns() - 1.0), y = std::clamp(row, 0.0, rows() - 1.0);
  const Post p{std::min(static_cast<int>(x), columns() - 2), std::min(static_cast<int>(y), rows() - 2)};
  const double u = x - p.i, v = y - p.j;
  const double low = (1 - u) * height(p) + u * height({p.i + 1, p.j});
  const double high = (1 - u) * height({p.i, p.j + 1}) + u * height({p.i + 1, p.j + 1});
  return (1 - v) * low + v * high;
}

std::vector<Vec3f> HeightField::places() const {
  std::vector<Vec3f> all;
  for (int j = 0; j < rows(); ++j)
    for (int i = 0; i < columns(); ++i) all.push_back(place({i, j}, height({i, j})));
  return all;
}

}  // namespace lodestone
