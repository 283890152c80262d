// The hierarchy of right triangles over a height field that longest-edge bisection makes (lindstrom1996, ulrich2002):
// which posts a tolerance needs, and the triangulation of a square by it.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "experiments/systems/terrain/height_field.h"

namespace lodestone {

// Squares of 2^k posts a side, with the first post at a multiple of the side.
struct Square {
  int i = 0, j = 0, side = 0;
};

class RightTriangles {
 public:
  explicit RightTriangles(const HeightField& field);  // that outlives it

  [[nodiscard]] int side() const { return side_; }  // of the square around the whole field: a power of two
  // The largest vertical distance of posts from the triangles that share the post as the middle of their longest edge,
  // if these are not split, and at least that of what their halves would be off by. By post of the square.
  [[nodiscard]] float error(Post p) const { return errors_[index(p)]; }
  // A tolerance at which about so many posts split triangles.
  [[nodiscard]] float tolerance_for(std::size_t splits) const;

  // Corners, counter-clockwise in the grid; clamped to it, without triangles of no area.
  using Corners = std::array<Post, 3>;
  // The triangles of a square by a tolerance. Squares beside each other that are cut by the same tolerance fit.
  [[nodiscard]] std::vector<Corners> cut(const Square& square, float tolerance) const;
  // The height of that triangulation over a post of the square.
  [[nodiscard]] float height(const Square& square, float tolerance, Post p) const;

 private:
  [[nodiscard]] std::size_t index(Post p) const {
    return static_cast<std::size_t>(p.j) * (static_cast<std::size_t>(side_) + 1) + static_cast<std::size_t>(p.i);
  }
  [[nodiscard]] bool splits(const Corners& t, float tolerance) const;
  void cut(const Corners& t, float tolerance, std::vector<Corners>& out) const;
  [[nodiscard]] std::optional<Corners> find(const Corners& t, float tolerance, Post p) const;  // the one with the post
  void measure(const Corners& t, int depth);
  [[nodiscard]] float own_error(const Corners& t) const;

  const HeightField& field_;
  int side_ = 1;
  std::vector<float> errors_;
};

}  // namespace lodestone
