// The bound of a cell's error against closed forms and against brute force: many points, every triangle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/hierarchy/construct/cell_error.h"
#include "core/hierarchy/construct/image_bound.h"
#include "core/hierarchy/construct/neighbourhood.h"
#include "core/spatial/point_triangle.h"
#include "tests/core/hierarchy/lattice_meshes.h"

namespace lodestone {
namespace {

using test::bumpy_sphere;
using test::naive_hierarchy;

LevelSurface surface_of(const Hierarchy& hierarchy, int level) {
  LevelSurface surface(hierarchy, level);
  for (CellRank c{0}; c < surface.cell_count(); ++c) surface.build_cell(c);
  surface.build_rest();
  return surface;
}

// Every triangle of the level and every vertex: the vertices without a triangle are what counts of those.
double brute_force(const Hierarchy& hierarchy, int level, Vec3d p) {
  double squared = HUGE_VAL;
  for (const Cell& cell : hierarchy.cells_of(level)) {
    for (const Vec3f v : cell.positions) squared = std::min(squared, squared_length(p - to_double(v)));
    for (const Triangle& t : cell.triangles)
      squared =
          std::min(squared, nearest_on_triangle(p, to_double(cell.positions[t.v[0]]), to_double(cell.positions[t.v[1]]),
                                                to_double(cell.positions[t.v[2]]))
                                .squared_distance);
  }
  return std::sqrt(squared);
}

// A distance that occurs, and one that none exceeds.
struct Bracket {
  double lower = 0, upper = 0;
};

Bracket from_cell(const Hierarchy& hierarchy, const Cell& cell, int to_level) {
  constexpr int steps = 6;
  Bracket result;
  for (const Triangle& t : cell.triangles) {
    const Vec3d a = to_double(cell.positions[t.v[0]]), b = to_double(cell.positions[t.v[1]]),
                c = to_double(cell.positions[t.v[2]]);
    double largest = 0;
    for (int i = 0; i <= steps; ++i)
      for (int k = 0; k <= steps - i; ++k)
        largest = std::max(largest, brute_force(hierarchy, to_level,
                                                a + (double(i) / steps) * (b - a) + (double(k) / steps) * (c - a)));
    result.lower = std::max(result.lower, largest);
    // No point is farther from a sample than the longest edge of a small triangle.
    const double longest = std::max({length(b - a), length(c - b), length(a - c)});
    result.upper = std::max(result.upper, largest + longest / steps);
  }
  return result;
}

bool is_below(const Hierarchy& hierarchy, CellId cell, CellId ancestor) {
  while (cell > ancestor) cell = hierarchy.cells[cell].parent;
  return cell == ancestor;
}

struct Measured {
  std::vector<double> error, by_images;  // by cell
};

Measured measure(const Hierarchy& hierarchy, double tolerance) {
  Measured result{std::vector<double>(hierarchy.cells.size()), std::vector<double>(hierarchy.cells.size())};
  const LevelSurface finest = surface_of(hierarchy, hierarchy.finest());
  CellErrorMeter meter({tolerance});
  const Level& leaves = hierarchy.levels.back();
  for (int l = 0; l < hierarchy.finest(); ++l) {
    const LevelSurface surface = surface_of(hierarchy, l);
    const Level& level = hierarchy.levels[static_cast<std::size_t>(l)];
    for (CellId c = level.first_cell; c < level.end_cell(); ++c) {
      CellRank begin(leaves.cell_count), end;
      for (CellRank k{0}; k < leaves.cell_count; ++k)
        if (is_below(hierarchy, leaves.id_of(k), c)) begin = std::min(begin, k), end = CellRank(k + 1);
      result.error[c] = meter.measure({surface, level.rank_of(c), finest, begin, end, 0, 1e-9}).bound;
      result.by_images[c] = image_bound(hierarchy, c, begin, end);
    }
  }
  return result;
}

class CellErrorOf : public testing::TestWithParam<std::pair<bool, double>> {};

TEST_P(CellErrorOf, EachCellIsAboveAllDistancesByTheToleranceAtMost) {
  const auto [open, tolerance] = GetParam();
  const Hierarchy hierarchy = naive_hierarchy(bumpy_sphere(3, open), 2, 1.2f).hierarchy;
  const Measured measured = measure(hierarchy, tolerance);
  const CellId first_finest = hierarchy.levels.back().first_cell;
  for (int l = 0; l < hierarchy.finest(); ++l) {
    const Level& level = hierarchy.levels[static_cast<std::size_t>(l)];
    for (CellId c = level.first_cell; c < level.end_cell(); ++c) {
      Bracket expected = from_cell(hierarchy, hierarchy.cells[c], hierarchy.finest());
      for (CellId k = first_finest; k < hierarchy.cells.size(); ++k) {
        if (!is_below(hierarchy, k, c)) continue;
        const Bracket back = from_cell(hierarchy, hierarchy.cells[k], l);
        expected = {std::max(expected.lower, back.lower), std::max(expected.upper, back.upper)};
      }
      EXPECT_GE(measured.error[c], expected.lower * (1 - 1e-12) - 1e-15) << "level " << l << " cell " << c;
      EXPECT_LE(measured.error[c], expected.upper * (1 + tolerance)) << "level " << l << " cell " << c;
      EXPECT_GE(measured.by_images[c], expected.lower * (1 - 1e-12) - 1e-15) << "level " << l << " cell " << c;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, CellErrorOf,
                         testing::Values(std::pair{false, 0.05}, std::pair{true, 0.05}, std::pair{false, 0.001},
                                         std::pair{true, 0.5}),
                         [](const auto& param) { return std::to_string(param.index); });

// Two levels of one cell each.
struct TwoLevels {
  std::vector<Vec3f> coarse, fine;
  std::vector<Triangle> coarse_triangles, fine_triangles;

  [[nodiscard]] double error(double tolerance = 1e-3, double known = 0) const {
    Hierarchy hierarchy;
    hierarchy.levels.resize(2);
    hierarchy.levels[0].cell_count = hierarchy.levels[1].cell_count = 1;
    hierarchy.levels[1].first_cell = CellId(1);
    hierarchy.cells.resize(2);
    hierarchy.cells[0].positions = coarse;
    hierarchy.cells[0].triangles = coarse_triangles;
    hierarchy.cells[1].positions = fine;
    hierarchy.cells[1].triangles = fine_triangles;
    return CellErrorMeter({tolerance})
        .measure(
            {surface_of(hierarchy, 0), CellRank(0), surface_of(hierarchy, 1), CellRank(0), CellRank(1), known, 1e-9})
        .bound;
  }
};

const std::vector<Vec3f> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<Triangle> two{{{0, 1, 2}}, {{0, 2, 3}}};

TEST(CellError, OfTheSameSurfaceCutOtherwiseIsNothing) {
  const TwoLevels levels{square,
                         {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.3f, 0.6f, 0}},
                         two,
                         {{{0, 1, 4}}, {{1, 2, 4}}, {{2, 3, 4}}, {{3, 0, 4}}}};
  EXPECT_LE(levels.error(), 1e-9);
}

TEST(CellError, OfAPyramidIsItsHeight) {
  const TwoLevels levels{square,
                         {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5f, 0.5f, 0.25f}},
                         two,
                         {{{0, 1, 4}}, {{1, 2, 4}}, {{2, 3, 4}}, {{3, 0, 4}}}};
  EXPECT_GE(levels.error(), 0.25);
  EXPECT_LE(levels.error(), 0.25 * 1.001);
  EXPECT_GE(levels.error(0.2), 0.25);
  EXPECT_LE(levels.error(0.2), 0.25 * 1.2);
}

// Forward and backward for themselves: one surface sticks out beyond the other, and no corner is the farthest point.
TEST(CellError, SeesBothDirections) {
  const std::vector<Vec3f> half{{0, 0, 0}, {0.5f, 0, 0}, {0.5f, 1, 0}, {0, 1, 0}};
  const TwoLevels forward{square, half, two, two}, backward{half, square, two, two};
  for (const TwoLevels& levels : {forward, backward}) {
    EXPECT_GE(levels.error(), 0.5);
    EXPECT_LE(levels.error(), 0.5 * 1.001);
  }
  // Two strips with a gap: the middle of the gap is the farthest point of the square.
  const TwoLevels gap{
      square,
      {{0, 0, 0}, {0.25f, 0, 0}, {0.25f, 1, 0}, {0, 1, 0}, {0.75f, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.75f, 1, 0}},
      two,
      {{{0, 1, 2}}, {{0, 2, 3}}, {{4, 5, 6}}, {{4, 6, 7}}}};
  EXPECT_GE(gap.error(), 0.25);
  EXPECT_LE(gap.error(), 0.25 * 1.001);
}

// A vertex that no triangle uses is what is left of an island.
TEST(CellError, OfACollapsedIslandIsTheWayToItsPoint) {
  TwoLevels levels{square, square, two, two};
  levels.fine.insert(levels.fine.end(), {{0, 0, 1}, {0.03f, 0, 1}, {0, 0.04f, 1}});
  levels.fine_triangles.push_back({{4, 5, 6}});
  levels.coarse.push_back({0, 0, 1});
  EXPECT_NEAR(levels.error(), 0.04, 0.04 * 0.002);
  levels.coarse.pop_back();
  EXPECT_NEAR(levels.error(), 1, 0.002);
}

TEST(CellError, IsAtLeastWhatIsKnown) {
  const TwoLevels levels{square,
                         {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5f, 0.5f, 0.25f}},
                         two,
                         {{{0, 1, 4}}, {{1, 2, 4}}, {{2, 3, 4}}, {{3, 0, 4}}}};
  EXPECT_EQ(levels.error(0.05, 0.5), 0.5);
  EXPECT_EQ(levels.error(0.05, 0.27), 0.27) << "no share of the tolerance on top";
}

// Triangles without an area and far too long ones.
TEST(CellError, BearsDegenerateTriangles) {
  const TwoLevels segment{{{0, 0, 0}, {1, 0, 0}, {0.5f, 0, 0}},
                          {{0, 0.1f, 0}, {1, 0.1f, 0}, {0.5f, 0.1f, 0}},
                          {{{0, 1, 2}}},
                          {{{0, 2, 1}}}};
  EXPECT_NEAR(segment.error(), 0.1, 2e-4);
  const TwoLevels needle{
      {{0, 0, 0}, {1, 0, 0}, {1, 1e-6f, 0}}, {{0, 0, 0.01f}, {1, 0, 0}, {1, 1e-6f, 0}}, {{{0, 1, 2}}}, {{{0, 1, 2}}}};
  EXPECT_NEAR(needle.error(), 0.01, 2e-5);
}

// A strip of needles across the axes, side by side, `rows` in its width; a bump of the given height along it.
struct Strip {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
};
Strip strip_of_needles(std::uint32_t rows, float height) {
  Strip strip;
  constexpr std::uint32_t columns = 6;
  for (std::uint32_t k = 0; k <= columns; ++k)
    for (std::uint32_t i = 0; i <= rows; ++i) {
      const float u = float(k) / columns, v = 0.002f * float(i) / float(rows);
      strip.positions.push_back({0.6f * u + v, 0.5f * u - v, 0.3f * u + height * std::sin(3 * u) * float(i % 2)});
    }
  for (std::uint32_t k = 0; k < columns; ++k)
    for (std::uint32_t i = 0; i < rows; ++i) {
      const std::uint32_t a = k * (rows + 1) + i, b = a + rows + 1;
      strip.triangles.push_back({{a, b, a + 1}});
      strip.triangles.push_back({{a + 1, b, b + 1}});
    }
  return strip;
}

Hierarchy hierarchy_of_two(const Strip& coarse, const Strip& fine) {
  Hierarchy hierarchy;
  hierarchy.levels.resize(2);
  hierarchy.levels[0].cell_count = hierarchy.levels[1].cell_count = 1;
  hierarchy.levels[1].first_cell = CellId(1);
  hierarchy.cells.resize(2);
  hierarchy.cells[0].positions = coarse.positions, hierarchy.cells[0].triangles = coarse.triangles;
  hierarchy.cells[1].positions = fine.positions, hierarchy.cells[1].triangles = fine.triangles;
  return hierarchy;
}

TEST(ImageBound, CountsTheEndsOfASegmentUnlessItIsAnEdge) {
  Strip fine{{{0, 0, 0}, {1, 0, 0}, {0, 0.01f, 0}, {0.5f, 1, 0}}, {{{0, 1, 2}}}};
  Strip coarse{{{0, 0, 0}, {1, 0, 0}, {0.5f, 1, 0}}, {}};
  const std::vector<std::uint32_t> parents{0, 1, 0, 2};
  const auto bound = [&] {
    Hierarchy hierarchy = hierarchy_of_two(coarse, fine);
    hierarchy.cells[1].parent = CellId(0);
    hierarchy.cells[1].parents = parents;
    return image_bound(hierarchy, CellId(0), CellRank(0), CellRank(1));
  };
  EXPECT_NEAR(bound(), 0.01 + 0.5, 1e-8);
  fine.triangles.push_back({{1, 0, 3}});
  coarse.triangles.push_back({{1, 0, 2}});
  EXPECT_NEAR(bound(), 0.01, 1e-8);
  coarse.positions[1].x = 0.5f;
  EXPECT_NEAR(bound(), 0.5, 1e-8);
}

// However many needles lie side by side: the work is what was allowed, and what results is a bound.
TEST(CellError, OfNeedlesIsABoundWithinTheTestsAllowed) {
  const Strip coarse = strip_of_needles(40, 0), fine = strip_of_needles(150, 1e-4f);
  const Hierarchy hierarchy = hierarchy_of_two(coarse, fine);
  const LevelSurface level = surface_of(hierarchy, 0), finest = surface_of(hierarchy, 1);
  const std::uint64_t triangles = coarse.triangles.size() + fine.triangles.size();
  double found = 0, exact = HUGE_VAL;
  for (const std::uint64_t tests : {std::uint64_t{0}, 1000 * triangles, 50 * triangles, std::uint64_t{1}}) {
    CellErrorMeter meter;
    const CellError error = meter.measure({.level = level,
                                           .cell = CellRank(0),
                                           .finest = finest,
                                           .first = CellRank(0),
                                           .end = CellRank(1),
                                           .tests = tests});
    found = std::max(found, error.found);
    if (tests == 0) exact = error.bound;
    EXPECT_GE(error.bound, found);
    EXPECT_GE(error.bound, exact / 1.05 * (1 - 1e-9)) << tests;
    EXPECT_EQ(error.complete, tests != 1 && error.bound <= 1.05 * error.found * (1 + 1e-9)) << tests;
    // The first pass of each of five attempts, and at most one piece more than allowed.
    EXPECT_TRUE(tests == 0 || meter.work().tests <= tests + 5 * (300 * triangles + 5000)) << tests;
  }
  EXPECT_LE(exact, 1.05 * found * (1 + 1e-9));
}

TEST(LevelSurface, FindsTheNearestItem) {
  const Hierarchy hierarchy = naive_hierarchy(bumpy_sphere(3), 2, 1.2f).hierarchy;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.2, 1.2);
  for (int l = 0; l <= hierarchy.finest(); ++l) {
    const LevelSurface surface = surface_of(hierarchy, l);
    SurfaceItem hint;
    for (int i = 0; i < 300; ++i) {
      const Vec3d p{place(random), place(random), place(random)};
      const double expected = brute_force(hierarchy, l, p);
      const LevelSurface::Nearest found = surface.nearest(p, hint);
      hint = found.item;
      EXPECT_NEAR(std::sqrt(found.squared_distance), expected, 1e-12);
      const auto [a, b, c] = surface.corners(found.item);
      EXPECT_EQ(nearest_on_triangle(p, a, b, c).squared_distance, found.squared_distance);
      const LevelSurface::Nearest enough = surface.nearest(p, {}, {.enough = 4 * expected * expected});
      EXPECT_LE(std::sqrt(enough.squared_distance), 2 * expected);
    }
  }
}

TEST(LevelSurface, FindsTheNearestNeedle) {
  const Strip strip = strip_of_needles(150, 1e-4f);
  const Hierarchy hierarchy = hierarchy_of_two(strip, strip);
  const LevelSurface surface = surface_of(hierarchy, 0);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> offset(-0.002f, 0.002f);
  Neighbourhood near;
  int within = 0;
  for (std::size_t v = 0; v < strip.positions.size(); v += 5) {
    const Vec3f p = strip.positions[v] + Vec3f{offset(random), offset(random), offset(random)};
    const double expected = brute_force(hierarchy, 0, to_double(p));
    EXPECT_NEAR(std::sqrt(surface.nearest(to_double(p)).squared_distance), expected, 1e-12);
    const LevelSurface::Nearest early = surface.nearest(to_double(p), {}, {.most = 8});
    EXPECT_LE(early.tested, 16u);
    EXPECT_GE(std::sqrt(early.squared_distance), expected - 1e-12);
    if (!near.gather(surface, {p, p}, 0.001, 512) || near.size() == 0) continue;
    const double found = near.nearest(to_double(p), 0).distance;
    if (expected > near.reach()) continue;
    ++within;
    EXPECT_NEAR(found, expected, 1e-12);
  }
  EXPECT_GT(within, 20);
}

TEST(Neighbourhood, HasTheNearestItemWithinItsReach) {
  const Hierarchy hierarchy = naive_hierarchy(bumpy_sphere(4), 2, 1.2f).hierarchy;
  const LevelSurface surface = surface_of(hierarchy, hierarchy.finest());
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(0, 1), offset(-0.05f, 0.05f);
  Neighbourhood near;
  int within = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3f middle{place(random), place(random), place(random)};
    Box3f box;
    std::vector<Vec3f> points;
    for (int k = 0; k < 5; ++k) {
      points.push_back(middle + Vec3f{offset(random), offset(random), offset(random)});
      box.extend(points.back());
    }
    ASSERT_TRUE(near.gather(surface, box, 0.08, 10'000));
    if (near.size() == 0) continue;
    for (const Vec3f p : points) {
      const double expected = brute_force(hierarchy, hierarchy.finest(), to_double(p));
      const Neighbourhood::Nearest found = near.nearest(to_double(p), static_cast<std::uint32_t>(near.size() - 1));
      EXPECT_GE(found.distance, expected - 1e-12);
      if (expected > near.reach()) continue;
      ++within;
      EXPECT_NEAR(found.distance, expected, 1e-12);
    }
  }
  EXPECT_GT(within, 200);
  const Box3f all{{0, 0, 0}, {1, 1, 1}};
  EXPECT_FALSE(near.gather(surface, all, 0.1, 100));
}

}  // namespace
}  // namespace lodestone
