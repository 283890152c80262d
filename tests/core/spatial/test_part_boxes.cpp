// Boxes of the parts of triangles: together they contain the triangle, and they are few.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/spatial/part_boxes.h"

namespace lodestone {
namespace {

using Corners = std::array<Vec3d, 3>;

std::vector<BoxTree::Item> divided(const std::vector<Corners>& triangles) {
  std::vector<BoxTree::Item> items;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    items.push_back({{}, t});
    for (const Vec3d p : triangles[t]) extend(items.back().box, p);
  }
  divide_boxes(
      items, triangles.size(), [&](std::uint32_t t) { return triangles[t]; }, 2 * triangles.size());
  return items;
}

// Across the axes unless `along` them.
std::vector<Corners> needles(int count, double width, bool along) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(0, 1);
  std::vector<Corners> triangles;
  for (int i = 0; i < count; ++i) {
    const Vec3d a{place(random), place(random), place(random)};
    const Vec3d way = along ? Vec3d{0.9, 0, 0} : Vec3d{0.5, 0.6, 0.4 * place(random)};
    triangles.push_back({a, a + way, a + way + Vec3d{0, 0, width}});
  }
  return triangles;
}

double half_area(const std::vector<BoxTree::Item>& items) {
  double sum = 0;
  for (const BoxTree::Item& item : items) {
    const Vec3d d = to_double(item.box.hi) - to_double(item.box.lo);
    sum += d.x * d.y + d.y * d.z + d.z * d.x;
  }
  return sum;
}

TEST(DivideBoxes, ContainEveryPointOfTheirTriangle) {
  const std::vector<Corners> triangles = needles(200, 0.001, false);
  const std::vector<BoxTree::Item> items = divided(triangles);
  EXPECT_GT(items.size(), 2 * triangles.size());
  EXPECT_LE(items.size(), 3 * triangles.size());
  constexpr int steps = 20;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (int i = 0; i <= steps; ++i)
      for (int k = 0; k <= steps - i; ++k) {
        const auto& [a, b, c] = triangles[t];
        const Vec3d p = a + (double(i) / steps) * (b - a) + (double(k) / steps) * (c - a);
        EXPECT_TRUE(std::any_of(items.begin(), items.end(), [&](const BoxTree::Item& item) {
          return item.number == t && squared_distance(p, item.box) < 1e-24;
        })) << t;
      }
  std::vector<BoxTree::Item> whole(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(triangles.size()));
  for (BoxTree::Item& item : whole)
    for (const Vec3d p : triangles[item.number]) extend(item.box, p);
  EXPECT_LT(half_area(items), 0.5 * half_area(whole));
}

TEST(DivideBoxes, LeaveOthersAsTheyAre) {
  EXPECT_EQ(divided(needles(200, 0.001, true)).size(), 200u) << "along an axis a box is tight";
  EXPECT_EQ(divided({}).size(), 0u);
  std::vector<Corners> lattice;
  for (int i = 0; i < 20; ++i)
    for (int k = 0; k < 20; ++k) {
      const Vec3d a{i / 20.0, k / 20.0, (i + k) / 20.0}, b = a + Vec3d{0.05, 0, 0.05}, c = a + Vec3d{0, 0.05, 0.05};
      lattice.push_back({a, b, c});
    }
  EXPECT_EQ(divided(lattice).size(), lattice.size());
}

}  // namespace
}  // namespace lodestone
