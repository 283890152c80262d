// Vectors of two and of three components, boxes and triangles as plain data: what crosses folder borders.
//
// Eigen and GLM appear inside algorithms; the interfaces carry these, so that a mesh buffer can be mapped from a file
// or handed to a graphics API unchanged. Every operation is a single rounding per component, in the order written:
// the crack-free guarantee needs the same bits from the same inputs everywhere.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace lodestone {

struct Vec2f {
  float x = 0, y = 0;
  friend constexpr bool operator==(const Vec2f&, const Vec2f&) = default;
};

struct Vec3f {
  float x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Vec3f&, const Vec3f&) = default;

  // Found by their arguments alone: a program with functions of these names may use the whole namespace.
  friend constexpr float dot(Vec3f a, Vec3f b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend constexpr Vec3f cross(Vec3f a, Vec3f b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  friend float length(Vec3f a) { return std::sqrt(dot(a, a)); }
  friend bool is_finite(Vec3f a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }
};

struct Vec3d {
  double x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Vec3d&, const Vec3d&) = default;
  friend constexpr double dot(Vec3d a, Vec3d b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend constexpr Vec3d cross(Vec3d a, Vec3d b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  friend double length(Vec3d a) { return std::sqrt(dot(a, a)); }
  friend bool is_finite(Vec3d a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }
};

constexpr Vec3f operator+(Vec3f a, Vec3f b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3f operator-(Vec3f a, Vec3f b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3f operator*(float s, Vec3f a) { return {s * a.x, s * a.y, s * a.z}; }

constexpr Vec3d operator+(Vec3d a, Vec3d b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3d operator-(Vec3d a, Vec3d b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3d operator*(double s, Vec3d a) { return {s * a.x, s * a.y, s * a.z}; }

constexpr Vec3d to_double(Vec3f a) { return {a.x, a.y, a.z}; }
constexpr Vec3f to_float(Vec3d a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

// Axis-aligned boxes, closed on both sides. An empty box has lo > hi and extends to whatever is added first.
template <class Vec>
struct Box3 {
  static constexpr decltype(Vec::x) far = std::numeric_limits<decltype(Vec::x)>::max();
  Vec lo{far, far, far};
  Vec hi{-far, -far, -far};

  [[nodiscard]] bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
  void extend(Vec p) { extend(Box3{p, p}); }
  void extend(const Box3& b) {
    lo = {std::min(lo.x, b.lo.x), std::min(lo.y, b.lo.y), std::min(lo.z, b.lo.z)};
    hi = {std::max(hi.x, b.hi.x), std::max(hi.y, b.hi.y), std::max(hi.z, b.hi.z)};
  }
  [[nodiscard]] bool contains(const Box3& b) const {
    return lo.x <= b.lo.x && lo.y <= b.lo.y && lo.z <= b.lo.z && hi.x >= b.hi.x && hi.y >= b.hi.y && hi.z >= b.hi.z;
  }
  [[nodiscard]] bool contains(Vec p) const { return contains(Box3{p, p}); }
  friend bool operator==(const Box3&, const Box3&) = default;
};

using Box3f = Box3<Vec3f>;
using Box3d = Box3<Vec3d>;

// Three vertex ids, counter-clockwise seen from outside. What they index is said where a Triangle is used.
struct Triangle {
  std::array<std::uint32_t, 3> v{};
  friend constexpr bool operator==(const Triangle&, const Triangle&) = default;
};

[[nodiscard]] constexpr bool is_degenerate(const Triangle& t) {
  return t.v[0] == t.v[1] || t.v[1] == t.v[2] || t.v[2] == t.v[0];
}

}  // namespace lodestone
