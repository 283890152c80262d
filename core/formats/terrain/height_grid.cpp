#include "core/formats/terrain/height_grid.h"

#include <cmath>
#include <limits>
#include <utility>

#include "core/base/error.h"

namespace lodestone {
namespace {

// A sum of heights weighted by inverse distances, per post. In double precision, so that level ground stays level.
struct Estimate {
  double weight = 0, height = 0;  // sum of weights, weighted sum of heights
};

// One sweep along a row or column of posts: each void post adds the latest known one to its estimate.
void sweep(std::span<const float> heights, std::span<Estimate> estimates, std::size_t first, std::ptrdiff_t step,
           std::size_t count) {
  float latest = void_height;
  std::size_t distance = 0;
  auto post = static_cast<std::ptrdiff_t>(first);
  for (std::size_t i = 0; i < count; ++i, post += step) {
    const auto at = static_cast<std::size_t>(post);
    ++distance;
    if (!std::isnan(heights[at])) {
      latest = heights[at];
      distance = 0;
    } else if (!std::isnan(latest)) {
      const double weight = 1 / static_cast<double>(distance);
      estimates[at].weight += weight;
      estimates[at].height += weight * latest;
    }
  }
}

// Fills the posts that have a known post in their row or column.
std::uint64_t fill_once(HeightGrid& grid) {
  std::vector<Estimate> estimates(grid.posts());
  const auto [width, height] = std::pair(grid.width, grid.height);
  for (std::size_t row = 0; row < height; ++row) {
    sweep(grid.heights, estimates, row * width, 1, width);
    sweep(grid.heights, estimates, row * width + width - 1, -1, width);
  }
  for (std::size_t column = 0; column < width; ++column) {
    sweep(grid.heights, estimates, column, static_cast<std::ptrdiff_t>(width), height);
    sweep(grid.heights, estimates, (height - 1) * width + column, -static_cast<std::ptrdiff_t>(width), height);
  }
  std::uint64_t filled = 0;
  for (std::size_t post = 0; post < grid.posts(); ++post) {
    if (!std::isnan(grid.heights[post]) || estimates[post].weight == 0) continue;
    grid.heights[post] = static_cast<float>(estimates[post].height / estimates[post].weight);
    ++filled;
  }
  return filled;
}

// The quads of a grid, one row of them at a time, seen from the south.
class Triangulation {
 public:
  explicit Triangulation(const HeightGrid& grid) : grid_(&grid), below_(grid.width), above_(grid.width) {}

  RawMesh run() {
    for (const float height : grid_->heights) mesh_.void_posts += std::isnan(height);
    add_vertices(0, below_);
    for (std::size_t row = 0; row + 1 < grid_->height; ++row) {
      add_vertices(row + 1, above_);
      add_quads(row);
      std::swap(below_, above_);
    }
    return std::move(mesh_);
  }

 private:
  // Rows count from the south here, from the north in the grid.
  [[nodiscard]] const float* row_of(std::size_t row) const {
    return grid_->heights.data() + (grid_->height - 1 - row) * grid_->width;
  }
  [[nodiscard]] bool has_quad(std::size_t row, std::size_t column) const {
    const float *south = row_of(row), *north = row_of(row + 1);
    return !std::isnan(south[column]) && !std::isnan(south[column + 1]) && !std::isnan(north[column]) &&
           !std::isnan(north[column + 1]);
  }
  [[nodiscard]] bool is_used(std::size_t row, std::size_t column) const {
    for (const std::size_t r : {row - 1, row})
      for (const std::size_t c : {column - 1, column})
        if (r < grid_->height - 1 && c < grid_->width - 1 && has_quad(r, c)) return true;  // 0 - 1 is beyond, too
    return false;
  }

  void add_vertices(std::size_t row, std::vector<std::uint32_t>& ids) {
    const double y = grid_->origin_y + static_cast<double>(row) * grid_->spacing_y;
    for (std::size_t column = 0; column < grid_->width; ++column) {
      ids[column] = static_cast<std::uint32_t>(mesh_.positions.size());
      if (!is_used(row, column)) continue;
      const double x = grid_->origin_x + static_cast<double>(column) * grid_->spacing_x;
      mesh_.positions.push_back({x, y, row_of(row)[column]});
    }
  }

  void add_quads(std::size_t row) {
    for (std::size_t column = 0; column + 1 < grid_->width; ++column) {
      if (!has_quad(row, column)) continue;
      const std::uint32_t south_west = below_[column], south_east = below_[column + 1];
      const std::uint32_t north_west = above_[column], north_east = above_[column + 1];
      mesh_.triangles.push_back({{south_west, south_east, north_east}});
      mesh_.triangles.push_back({{south_west, north_east, north_west}});
    }
  }

  const HeightGrid* grid_;
  RawMesh mesh_;
  std::vector<std::uint32_t> below_, above_;  // vertex of each post of two rows
};

}  // namespace

std::uint64_t fill_voids(HeightGrid& grid) {
  std::uint64_t total = 0;
  while (const std::uint64_t filled = fill_once(grid)) total += filled;
  return total;
}

RawMesh triangulate(const HeightGrid& grid, const std::string& name) {
  if (grid.posts() > std::numeric_limits<std::uint32_t>::max())
    throw ResourceError(describe(name, "", "more posts than 32-bit indices reach", "split the grid"));
  return Triangulation(grid).run();
}

}  // namespace lodestone
