#include "experiments/systems/terrain/right_triangles.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>

namespace lodestone {
namespace {

using Corners = RightTriangles::Corners;  // the longest edge goes from the first to the second

Post middle(const Corners& t) { return {(t[0].i + t[1].i) / 2, (t[0].j + t[1].j) / 2}; }

std::array<Corners, 2> halves(const Corners& t) {
  return {Corners{t[2], t[0], middle(t)}, Corners{t[1], t[2], middle(t)}};
}

bool is_smallest(const Corners& t) { return std::abs(t[0].i - t[2].i) + std::abs(t[0].j - t[2].j) <= 1; }

std::int64_t turn(Post a, Post b, Post c) {
  return std::int64_t{b.i - a.i} * (c.j - a.j) - std::int64_t{b.j - a.j} * (c.i - a.i);
}

// Both halves of a square; diagonals meet at the middle of the square around four.
std::array<Corners, 2> halves_of(const Square& s) {
  const Post a{s.i, s.j}, b{s.i + s.side, s.j}, c{s.i + s.side, s.j + s.side}, d{s.i, s.j + s.side};
  if ((s.i / s.side + s.j / s.side) % 2 == 0) return {Corners{c, a, b}, Corners{a, c, d}};
  return {Corners{b, d, a}, Corners{d, b, c}};
}

}  // namespace

RightTriangles::RightTriangles(const HeightField& field) : field_(field) {
  while (side_ < std::max(field.columns(), field.rows()) - 1) side_ *= 2;
  errors_.assign((static_cast<std::size_t>(side_) + 1) * (static_cast<std::size_t>(side_) + 1), 0);
  int depth = 0;
  for (int side = side_; side > 1; side /= 2) depth += 2;
  // Deepest first, so that the errors of halves are complete.
  for (; depth >= 0; --depth)
    for (const Corners& t : halves_of({0, 0, side_})) measure(t, depth);
}

// Raises the errors of the triangles so many halvings below.
void RightTriangles::measure(const Corners& t, int depth) {
  if (is_smallest(t)) return;
  const auto [a, b] = halves(t);
  if (depth > 0) {
    measure(a, depth - 1);
    measure(b, depth - 1);
    return;
  }
  float& error = errors_[index(middle(t))];
  error = std::max(error, own_error(t));
  for (const Corners& half : {a, b})
    if (!is_smallest(half)) error = std::max(error, errors_[index(middle(half))]);
}

float RightTriangles::own_error(const Corners& t) const {
  const Post a = field_.clamped(t[0]), b = field_.clamped(t[1]), c = field_.clamped(t[2]);
  const std::int64_t whole = turn(a, b, c);
  if (whole == 0) return 0;
  const auto [left, right] = std::minmax({a.i, b.i, c.i});
  const auto [low, high] = std::minmax({a.j, b.j, c.j});
  double error = 0;
  for (int j = low; j <= high; ++j)
    for (int i = left; i <= right; ++i) {
      const Post p{i, j};
      const std::int64_t of_a = turn(b, c, p), of_b = turn(c, a, p), of_c = turn(a, b, p);
      if (of_a < 0 || of_b < 0 || of_c < 0) continue;
      const double plane =
          (static_cast<double>(of_a) * field_.height(a) + static_cast<double>(of_b) * field_.height(b) +
           static_cast<double>(of_c) * field_.height(c)) /
          static_cast<double>(whole);
      error = std::max(error, std::abs(plane - field_.height(p)));
    }
  return static_cast<float>(error * (1 + 1e-6));
}

float RightTriangles::tolerance_for(std::size_t splits) const {
  std::vector<float> errors;
  for (const float error : errors_)
    if (error > 0) errors.push_back(error);
  if (splits >= errors.size()) return 0;
  const auto at = errors.begin() + static_cast<std::ptrdiff_t>(splits);
  std::ranges::nth_element(errors, at, std::greater<>());
  return *at;
}

bool RightTriangles::splits(const Corners& t, float tolerance) const {
  return !is_smallest(t) && errors_[index(middle(t))] > tolerance;
}

void RightTriangles::cut(const Corners& t, float tolerance, std::vector<Corners>& out) const {
  if (splits(t, tolerance)) {
    for (const Corners& half : halves(t)) cut(half, tolerance, out);
    return;
  }
  const Corners drawn{field_.clamped(t[0]), field_.clamped(t[1]), field_.clamped(t[2])};
  if (turn(drawn[0], drawn[1], drawn[2]) != 0) out.push_back(drawn);
}

std::vector<RightTriangles::Corners> RightTriangles::cut(const Square& square, float tolerance) const {
  std::vector<Corners> out;
  for (const Corners& t : halves_of(square)) cut(t, tolerance, out);
  return out;
}

// Beyond the ends of the field, posts that are clamped pull a triangle out of the place where its halves are: then both
// halves are looked at.
std::optional<Corners> RightTriangles::find(const Corners& t, float tolerance, Post p) const {
  const Post a = field_.clamped(t[0]), b = field_.clamped(t[1]), c = field_.clamped(t[2]);
  const auto [left, right] = std::minmax({a.i, b.i, c.i});
  const auto [low, high] = std::minmax({a.j, b.j, c.j});
  if (p.i < left || p.i > right || p.j < low || p.j > high) return std::nullopt;
  const bool within = turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
  const bool moved = !(a == t[0] && b == t[1] && c == t[2]);
  if (!within && !moved) return std::nullopt;
  if (!splits(t, tolerance)) return within && turn(a, b, c) > 0 ? std::optional(Corners{a, b, c}) : std::nullopt;
  for (const Corners& half : halves(t))
    if (const auto found = find(half, tolerance, p)) return found;
  return std::nullopt;
}

float RightTriangles::height(const Square& square, float tolerance, Post p) const {
  std::optional<Corners> found;
  for (const Corners& t : halves_of(square))
    if (!found) found = find(t, tolerance, p);
  assert(found);
  const auto& [a, b, c] = *found;
  for (const Post corner : {a, b, c})
    if (corner == p) return field_.height(p);
  const auto whole = static_cast<double>(turn(a, b, c));
  return static_cast<float>((static_cast<double>(turn(b, c, p)) * field_.height(a) +
                             static_cast<double>(turn(c, a, p)) * field_.height(b) +
                             static_cast<double>(turn(a, b, p)) * field_.height(c)) /
                            whole);
}

}  // namespace lodestone
