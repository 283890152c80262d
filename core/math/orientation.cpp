#include "core/math/orientation.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace lodestone {
namespace {

// A sum of doubles that do not overlap, in ascending order of magnitude: its sign is that of the last one.
class Expansion {
 public:
  void add(double value) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < size_; ++k) {
      const double sum = value + parts_[k], virtual_part = sum - value;
      const double rest = (value - (sum - virtual_part)) + (parts_[k] - virtual_part);
      if (rest != 0) parts_[kept++] = rest;
      value = sum;
    }
    if (value != 0) parts_[kept++] = value;
    size_ = kept;
  }
  // Adds a * b * c: each product of two doubles is two doubles.
  void add_product(double a, double b, double c) {
    const double ab = a * b, ab_rest = std::fma(a, b, -ab);
    for (const double part : {ab_rest, ab}) {
      const double product = part * c;
      add(std::fma(part, c, -product));
      add(product);
    }
  }
  [[nodiscard]] int sign() const { return size_ == 0 ? 0 : parts_[size_ - 1] > 0 ? 1 : -1; }

 private:
  std::array<double, 25> parts_{};  // six products of four doubles each
  std::size_t size_ = 0;
};

int exact_orientation(Vec3d a, Vec3d b, Vec3d c) {
  Expansion sum;
  sum.add_product(a.x, b.y, c.z), sum.add_product(-a.x, b.z, c.y);
  sum.add_product(a.y, b.z, c.x), sum.add_product(-a.y, b.x, c.z);
  sum.add_product(a.z, b.x, c.y), sum.add_product(-a.z, b.y, c.x);
  return sum.sign();
}

constexpr double rounding = 0x1p-53;
constexpr double smallest = 1e-250;  // sums of products below it may have lost digits

}  // namespace

int orientation(Vec3d a, Vec3d b, Vec3d c) {
  const double det = dot(a, cross(b, c));
  // Each term takes part in five roundings at most; the bound allows for eight, its own among them.
  const double size = std::abs(a.x) * (std::abs(b.y * c.z) + std::abs(b.z * c.y)) +
                      std::abs(a.y) * (std::abs(b.z * c.x) + std::abs(b.x * c.z)) +
                      std::abs(a.z) * (std::abs(b.x * c.y) + std::abs(b.y * c.x));
  if (size > smallest && std::abs(det) > 8 * rounding * size) return det > 0 ? 1 : -1;
  return exact_orientation(a, b, c);
}

int orientation(Vec2d a, Vec2d b, Vec2d c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double det = left - right, size = std::abs(left) + std::abs(right);
  // Differences, products and their difference are rounded: little more than three times each (shewchuk1997).
  if (size > smallest && std::abs(det) > 4 * rounding * size) return det > 0 ? 1 : -1;
  return exact_orientation({a.x, a.y, 1}, {b.x, b.y, 1}, {c.x, c.y, 1});
}

}  // namespace lodestone
