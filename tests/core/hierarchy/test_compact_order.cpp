// Triangles along a curve through the boxes of their cell.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <set>

#include "core/hierarchy/construct/compact_order.h"

namespace lodestone {
namespace {

TEST(CompactOrder, TheCurveVisitsEveryBoxAndStepsFromSideToSide) {
  std::vector<CellCoord> by_place(512);
  std::set<std::uint16_t> seen;
  for (std::uint16_t x = 0; x < 8; ++x)
    for (std::uint16_t y = 0; y < 8; ++y)
      for (std::uint16_t z = 0; z < 8; ++z) {
        const std::uint16_t place = curve_place({x, y, z});
        ASSERT_LT(place, 512);
        ASSERT_TRUE(seen.insert(place).second);
        by_place[place] = {x, y, z};
      }
  for (std::size_t i = 1; i < by_place.size(); ++i) {
    const CellCoord a = by_place[i - 1], b = by_place[i];
    EXPECT_EQ(std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z), 1) << i;
  }
}

// The cell has triangles that stick out of it, and some that are equal.
TEST(CompactOrder, SortsAsAStableSortByPlaceDoes) {
  constexpr int level = 3;
  const CellCoord cell{2, 0, 7};
  std::mt19937 random(5);
  std::uniform_real_distribution<float> offset(-0.2f, 1.2f);
  std::vector<Float4> positions;
  const auto coordinate = [&](std::uint16_t at) { return (static_cast<float>(at) + offset(random)) / 8; };
  for (int i = 0; i < 400; ++i)
    positions.push_back(to_float4(Vec3f{coordinate(cell.x), coordinate(cell.y), coordinate(cell.z)}));
  std::vector<Triangle> triangles;
  for (int i = 0; i < 900; ++i) {
    const auto corner = [&] { return static_cast<std::uint32_t>(random() % positions.size()); };
    triangles.push_back({{corner(), corner(), corner()}});
    if (i % 7 == 0) triangles.push_back(triangles.back());
  }
  const auto place = [&](const Triangle& t) {
    const auto at = [&](std::uint32_t v) { return to_vec3f(positions[v]); };
    const Vec3f middle = barycentre(at(t.v[0]), at(t.v[1]), at(t.v[2]));
    const auto box = [](float v, std::uint16_t axis) {
      return static_cast<std::uint16_t>(std::clamp(std::floor(v * 64) - 8 * static_cast<float>(axis), 0.0f, 7.0f));
    };
    return curve_place({box(middle.x, cell.x), box(middle.y, cell.y), box(middle.z, cell.z)});
  };
  std::vector<Triangle> sorted(triangles.size()), expected = triangles;
  std::ranges::stable_sort(expected, {}, place);
  CompactOrderScratch scratch;
  sort_compactly(triangles, positions, CellCode::from(cell), level, sorted, scratch);
  EXPECT_EQ(sorted, expected);
  sort_compactly({}, positions, CellCode::from(cell), level, {}, scratch);
}

}  // namespace
}  // namespace lodestone
