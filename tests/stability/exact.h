// Vectors and distances over any kind of number: rationals, against which bounds and kernels are checked, and float,
// double and long double, to see what a precision costs and gains. Straight from the definitions.
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "core/math/vec3.h"
#include "core/spatial/point_triangle.h"

namespace lodestone::test {

using Rational = mpq_class;

inline Rational square(const Rational& v) { return v * v; }
inline Rational fraction(unsigned numerator, unsigned denominator) {
  Rational v(numerator, denominator);
  v.canonicalize();
  return v;
}

// Sums and products of rationals are expressions: each result is named as a number.
template <class T>
struct Vec {
  T x{}, y{}, z{};
  friend Vec operator+(const Vec& a, const Vec& b) { return {T(a.x + b.x), T(a.y + b.y), T(a.z + b.z)}; }
  friend Vec operator-(const Vec& a, const Vec& b) { return {T(a.x - b.x), T(a.y - b.y), T(a.z - b.z)}; }
  friend Vec operator*(const T& s, const Vec& a) { return {T(s * a.x), T(s * a.y), T(s * a.z)}; }
};
template <class T>
T dot(const Vec<T>& a, const Vec<T>& b) {
  return T(a.x * b.x + a.y * b.y + a.z * b.z);
}
template <class T>
Vec<T> cross(const Vec<T>& a, const Vec<T>& b) {
  return {T(a.y * b.z - a.z * b.y), T(a.z * b.x - a.x * b.z), T(a.x * b.y - a.y * b.x)};
}
template <class T>
T squared_length(const Vec<T>& a) {
  return dot(a, a);
}
template <class T>
T squared_distance(const Vec<T>& a, const Vec<T>& b) {
  return squared_length(a - b);
}

using ExactPoint = Vec<Rational>;
template <class T>
using Corners = std::array<Vec<T>, 3>;
using ExactTriangle = Corners<Rational>;

// Every finite double is a rational; from a double to float rounds.
template <class T>
Vec<T> as(Vec3d p) {
  return {T(p.x), T(p.y), T(p.z)};
}
inline ExactPoint exact(Vec3d p) { return as<Rational>(p); }
inline ExactPoint exact(Vec3f p) { return exact(to_double(p)); }
inline Vec3d to_double(const ExactPoint& p) { return {p.x.get_d(), p.y.get_d(), p.z.get_d()}; }

// The nearest point of the segment; `a` if both ends are the same.
template <class T>
Vec<T> nearest_on_segment(const Vec<T>& p, const Vec<T>& a, const Vec<T>& b) {
  const Vec<T> ab = b - a;
  const T along = dot(p - a, ab), whole = squared_length(ab);
  if (!(along > 0) || !(whole > 0)) return a;
  if (along >= whole) return b;
  return a + T(along / whole) * ab;
}

// The foot of the perpendicular if it is inside, or else the nearest point of the three edges.
template <class T>
Vec<T> nearest_on_triangle(const Vec<T>& p, const Corners<T>& t) {
  const Vec<T> ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0], normal = cross(ab, ac);
  const T area2 = squared_length(normal);
  if (area2 > 0) {
    const T b = dot(cross(ap, ac), normal), c = dot(cross(ab, ap), normal);
    if (b >= 0 && c >= 0 && b + c <= area2) return t[0] + (T(b / area2) * ab + T(c / area2) * ac);
  }
  Vec<T> nearest = nearest_on_segment(p, t[0], t[1]);
  for (std::size_t k = 1; k < 3; ++k) {
    const Vec<T> q = nearest_on_segment(p, t[k], t[(k + 1) % 3]);
    if (squared_distance(p, q) < squared_distance(p, nearest)) nearest = q;
  }
  return nearest;
}

template <class T>
T squared_distance(const Vec<T>& p, const Corners<T>& t) {
  return squared_distance(p, nearest_on_triangle(p, t));
}

// A surface and its exact twin.
class ExactSurface {
 public:
  ExactSurface(std::vector<Vec3d> positions, std::vector<Triangle> triangles)
      : positions_(std::move(positions)), triangles_(std::move(triangles)) {
    for (const Vec3d p : positions_) exact_.push_back(exact(p));
  }

  [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }
  [[nodiscard]] ExactTriangle corners(const Triangle& t) const {
    return {exact_[t.v[0]], exact_[t.v[1]], exact_[t.v[2]]};
  }

  // True if the distance of p from the surface is at most that. Doubles say which triangles are tried, and first.
  [[nodiscard]] bool is_within(const ExactPoint& p, const Rational& distance) const {
    const Rational most = square(distance);
    const double nearby = 1.01 * most.get_d() + 1e-18;
    const Vec3d about = to_double(p);
    std::vector<std::pair<double, const Triangle*>> order;
    for (const Triangle& t : triangles_) {
      const double squared =
          lodestone::nearest_on_triangle(about, positions_[t.v[0]], positions_[t.v[1]], positions_[t.v[2]])
              .squared_distance;
      if (squared <= nearby) order.emplace_back(squared, &t);
    }
    std::sort(order.begin(), order.end());
    return std::any_of(order.begin(), order.end(),
                       [&](const auto& near) { return squared_distance(p, corners(*near.second)) <= most; });
  }

 private:
  std::vector<Vec3d> positions_;
  std::vector<ExactPoint> exact_;
  std::vector<Triangle> triangles_;
};

// Corners, middles of edges, the middle, and a point of its own in each triangle.
inline std::vector<ExactPoint> points_of(const ExactTriangle& t, unsigned number) {
  const Rational half = fraction(1, 2), third = fraction(1, 3), u = fraction(number * 7 % 61, 61);
  const Rational v = (1 - u) * fraction(number * 11 % 53, 53);
  return {t[0],
          t[1],
          t[2],
          half * (t[0] + t[1]),
          half * (t[1] + t[2]),
          half * (t[2] + t[0]),
          third * (t[0] + (t[1] + t[2])),
          t[0] + (u * (t[1] - t[0]) + v * (t[2] - t[0]))};
}

}  // namespace lodestone::test
