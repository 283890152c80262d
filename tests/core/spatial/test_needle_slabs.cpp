// Searches among needles side by side: exact, and few of them are tested.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "core/spatial/box_tree.h"
#include "core/spatial/part_boxes.h"
#include "core/spatial/triangle_bvh.h"

namespace lodestone {
namespace {

using Corners = std::array<Vec3d, 3>;

struct Needles {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;

  void add(Vec3d a, Vec3d b, Vec3d c) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.push_back({{first, first + 1, first + 2}});
  }
  [[nodiscard]] Corners corners(std::uint32_t t) const {
    const auto& v = triangles[t].v;
    return {positions[v[0]], positions[v[1]], positions[v[2]]};
  }
};

// All around a hub, on a wavy cone.
Needles wheel(std::uint32_t count) {
  const auto rim = [&](std::uint32_t k) {
    const double turn = 2 * std::numbers::pi * (k % count) / count;
    return Vec3d{0.5 + 0.5 * std::cos(turn), 0.5 + 0.5 * std::sin(turn), 0.01 * std::sin(40 * turn)};
  };
  Needles needles;
  for (std::uint32_t k = 0; k < count; ++k) needles.add({0.5, 0.5, 0.1}, rim(k), rim(k + 1));
  return needles;
}

// Beside each other, across the axes.
Needles strip(std::uint32_t count) {
  const Vec3d along{0.5, 0.4, 0.3}, step = (1.0 / count) * Vec3d{0.4, -0.5, 0};
  Needles needles;
  for (std::uint32_t k = 0; k < count; ++k)
    needles.add(double(k) * step, double(k) * step + along, double(k + 1) * step);
  return needles;
}

std::vector<Vec3d> points_near(const Needles& needles, double farthest) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0, 1), away(-farthest, farthest);
  std::vector<Vec3d> points;
  for (int i = 0; i < 300; ++i) {
    const Corners t = needles.corners(static_cast<std::uint32_t>(random() % needles.triangles.size()));
    const double u = share(random), v = share(random) * (1 - u);
    points.push_back(t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]) + Vec3d{away(random), away(random), away(random)});
  }
  return points;
}

double squared_distance_of(const Needles& needles, Vec3d p, std::uint32_t t) {
  const Corners c = needles.corners(t);
  return nearest_on_triangle(p, c[0], c[1], c[2]).squared_distance;
}

TEST(NeedleSlabs, SearchesAreExact) {
  for (const Needles& needles : {wheel(3000), strip(3000)}) {
    const TriangleBvh bvh(needles.positions, needles.triangles);
    for (const double farthest : {0.0, 1e-8, 1e-3, 0.3})
      for (const Vec3d p : points_near(needles, farthest)) {
        double least = std::numeric_limits<double>::infinity();
        for (std::uint32_t t = 0; t < needles.triangles.size(); ++t)
          least = std::min(least, squared_distance_of(needles, p, t));
        EXPECT_NEAR(std::sqrt(bvh.nearest(p).squared_distance), std::sqrt(least), 3e-16 + 1e-15 * std::sqrt(least));
      }
  }
}

// Items tested for a point, on average.
double tested(const Needles& needles, double farthest) {
  const auto count = static_cast<std::uint32_t>(needles.triangles.size());
  std::vector<Corners> corners;
  std::vector<BoxTree::Item> items;
  for (std::uint32_t t = 0; t < count; ++t) {
    corners.push_back(needles.corners(t));
    items.push_back({{}, t});
    for (const Vec3d p : corners.back()) extend(items.back().box, p);
  }
  divide_boxes(
      items, corners.size(), [&](std::uint32_t t) { return corners[t]; }, 2 * corners.size());
  BoxTree tree(std::move(items), 4);
  const auto corners_of = [&](std::uint32_t slot) { return corners[tree.items()[slot]]; };
  EXPECT_TRUE(are_side_by_side(static_cast<std::uint32_t>(tree.items().size()), corners_of));
  tree.add_slabs(corners_of);
  const std::vector<Vec3d> points = points_near(needles, farthest);
  std::size_t tests = 0;
  for (const Vec3d p : points) {
    double least = std::numeric_limits<double>::infinity();
    tree.search(p, least, [&](BoxTree::Slots slots) {
      for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot, ++tests)
        least = std::min(least, squared_distance_of(needles, p, tree.items()[slot]));
      return false;
    });
  }
  return static_cast<double>(tests) / static_cast<double>(points.size());
}

// By boxes alone thousands of 40,000 would be tested.
TEST(NeedleSlabs, FewAreTested) {
  for (const Needles& needles : {wheel(40'000), strip(40'000)}) {
    EXPECT_LT(tested(needles, 0), 40);
    EXPECT_LT(tested(needles, 1e-8), 40);
    EXPECT_LT(tested(needles, 1e-3), 80);
  }
}

TEST(NeedleSlabs, OthersAreNotSideBySide) {
  std::mt19937 random(7);
  std::normal_distribution<double> place;
  std::vector<Corners> hay;
  for (int i = 0; i < 1000; ++i) {
    const Vec3d a{place(random), place(random), place(random)}, b{place(random), place(random), place(random)};
    hay.push_back({a, b, b + Vec3d{0, 0, 1e-6}});
  }
  EXPECT_FALSE(are_side_by_side(1000, [&](std::uint32_t i) { return hay[i]; }));
  EXPECT_FALSE(are_side_by_side(0, [&](std::uint32_t i) { return hay[i]; }));
}

}  // namespace
}  // namespace lodestone
