// A model that is a height field: posts on a grid with a height each, as levels of detail for terrain ask for.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "experiments/systems/surface/welded_surface.h"

namespace lodestone {

// A place in the grid. Levels count on beyond its end: what lies there is drawn at its last row or column.
struct Post {
  int i = 0, j = 0;  // column, row
  friend bool operator==(const Post&, const Post&) = default;
};

class HeightField {
 public:
  // Throws InputError that names the system for a surface that is not a grid of posts with two triangles in each
  // square.
  HeightField(const WeldedSurface& surface, std::string_view system);

  [[nodiscard]] int columns() const { return static_cast<int>(across_.size()); }
  [[nodiscard]] int rows() const { return static_cast<int>(along_.size()); }
  [[nodiscard]] std::size_t index(Post p) const {
    return static_cast<std::size_t>(p.j) * across_.size() + static_cast<std::size_t>(p.i);
  }
  [[nodiscard]] Post clamped(Post p) const {
    return {std::clamp(p.i, 0, columns() - 1), std::clamp(p.j, 0, rows() - 1)};
  }
  // Posts must be of the grid. Heights and places are in normalised space.
  [[nodiscard]] float height(Post p) const { return heights_[index(p)]; }
  [[nodiscard]] PackedNormal normal(Post p) const { return normals_[index(p)]; }
  [[nodiscard]] Vec3f place(Post p, float height) const;
  // True where the diagonal of a square goes from its first post to the opposite one; the square is named by its first.
  [[nodiscard]] bool has_main_diagonal(Post p) const { return main_diagonal_[index(p)] != 0; }
  // A triangle that is counter-clockwise in the grid, as the surface turns its face.
  [[nodiscard]] Triangle facing(Triangle t) const { return mirrored_ ? Triangle{{t.v[0], t.v[2], t.v[1]}} : t; }
  // Columns, rows and height of a place, both counted in fractions of the grid, which goes on beyond its ends.
  struct Over {
    double column = 0, row = 0, height = 0;
  };
  [[nodiscard]] Over over(Vec3f place) const;
  [[nodiscard]] double spacing() const;                             // of posts, mean of both directions
  [[nodiscard]] double height_at(double column, double row) const;  // of the nearest place of the grid, bilinear

  // All posts, by index.
  [[nodiscard]] std::vector<Vec3f> places() const;

 private:
  bool try_axes(const WeldedSurface& surface, std::array<int, 3> axes);

  std::array<int, 3> axes_{};  // of columns, rows and heights
  std::vector<float> across_, along_, heights_;
  std::vector<PackedNormal> normals_;
  std::vector<std::uint8_t> main_diagonal_;
  bool mirrored_ = false;
};

}  // namespace lodestone
