// Cuts of polygons are checked as chains of signed areas: triangles that are turned as the polygon is, whose edges
// cancel but for the outline, and whose areas add up to that of the polygon, cover its inside once and nothing else.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <utility>

#include "core/mesh/hard/hard_cases.h"
#include "core/mesh/polygons.h"

namespace lodestone {
namespace {

struct Point {
  std::int64_t x = 0, y = 0;
  friend bool operator==(const Point&, const Point&) = default;
};
using Outline = std::vector<Point>;

std::int64_t twice_area(Point a, Point b, Point c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

std::int64_t twice_area(const Outline& outline) {
  std::int64_t sum = 0;
  for (std::size_t k = 2; k < outline.size(); ++k) sum += twice_area(outline[0], outline[k - 1], outline[k]);
  return sum;
}

// In the plane through three points.
std::vector<Vec3d> in_space(const Outline& outline, Vec3d origin = {}, Vec3d u = {1, 0, 0}, Vec3d v = {0, 1, 0}) {
  std::vector<Vec3d> polygon;
  for (const Point p : outline) polygon.push_back(origin + static_cast<double>(p.x) * u + static_cast<double>(p.y) * v);
  return polygon;
}

std::vector<Triangle> fan(std::size_t corners) {
  std::vector<Triangle> triangles;
  for (std::uint32_t k = 2; k < corners; ++k) triangles.push_back({{0, k - 1, k}});
  return triangles;
}

// The triangles that a reader gives for the polygon.
std::vector<Triangle> cut_or_fan(std::span<const Vec3d> polygon) {
  const std::vector<Triangle> cut = cut_polygon(polygon);
  return cut.empty() ? fan(polygon.size()) : cut;
}

// The outline is one cycle through all corners; all other edges are there once in each direction.
void expect_edges_of_outline(std::size_t corners, const std::vector<Triangle>& triangles) {
  ASSERT_EQ(triangles.size(), corners - 2);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_LT(t.v[k], corners);
      ++edges[{t.v[k], t.v[(k + 1) % 3]}];
    }
  for (std::uint32_t k = 0; k < corners; ++k) --edges[{k, static_cast<std::uint32_t>((k + 1) % corners)}];
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    ASSERT_EQ(count, back == edges.end() ? 0 : back->second) << edge.first << " " << edge.second;
  }
}

void expect_covered_once(const Outline& outline, const std::vector<Triangle>& triangles) {
  ASSERT_NO_FATAL_FAILURE(expect_edges_of_outline(outline.size(), triangles));
  const std::int64_t side = twice_area(outline) < 0 ? -1 : 1;
  std::int64_t sum = 0;
  for (const Triangle& t : triangles) {
    const std::int64_t area = twice_area(outline[t.v[0]], outline[t.v[1]], outline[t.v[2]]);
    ASSERT_GE(side * area, 0) << t.v[0] << " " << t.v[1] << " " << t.v[2];
    sum += area;
  }
  ASSERT_EQ(sum, twice_area(outline));
}

// The slow twin of what decides between a fan and a cut.
bool fan_is_right(const Outline& outline) {
  std::vector<std::int64_t> areas;
  for (const Triangle& t : fan(outline.size()))
    areas.push_back(twice_area(outline[t.v[0]], outline[t.v[1]], outline[t.v[2]]));
  return twice_area(outline) == 0 || std::all_of(areas.begin(), areas.end(), [](auto a) { return a >= 0; }) ||
         std::all_of(areas.begin(), areas.end(), [](auto a) { return a <= 0; });
}

// In several planes, and turned over.
void expect_good_cut(const Outline& outline) {
  const std::array<std::array<Vec3d, 3>, 4> planes{{{{{}, {1, 0, 0}, {0, 1, 0}}},
                                                    {{{-3, 8, 1000}, {0, 2, 1}, {0, -1, 4}}},
                                                    {{{1e6, 1e6, 0}, {3, 2, 7}, {-5, 1, 2}}},
                                                    {{{}, {-0.25, 0, 0.5}, {0, -0.125, 0}}}}};
  for (const auto& [origin, u, v] : planes) {
    const std::vector<Vec3d> polygon = in_space(outline, origin, u, v);
    ASSERT_NO_FATAL_FAILURE(expect_covered_once(outline, cut_or_fan(polygon)));
    ASSERT_EQ(cut_polygon(polygon).empty(), fan_is_right(outline));
  }
  Outline back(outline.rbegin(), outline.rend());
  ASSERT_NO_FATAL_FAILURE(expect_covered_once(back, cut_or_fan(in_space(back))));
}

bool share_a_point(Point a, Point b, Point c, Point d) {
  const auto sign = [](std::int64_t x) { return (x > 0) - (x < 0); };
  const auto between = [](Point p, Point q, Point r) {
    return std::min(p.x, q.x) <= r.x && r.x <= std::max(p.x, q.x) && std::min(p.y, q.y) <= r.y &&
           r.y <= std::max(p.y, q.y);
  };
  const int ac = sign(twice_area(a, b, c)), ad = sign(twice_area(a, b, d));
  const int ca = sign(twice_area(c, d, a)), cb = sign(twice_area(c, d, b));
  if (ac != ad && ca != cb && ac * ad <= 0 && ca * cb <= 0) return true;
  return (ac == 0 && between(a, b, c)) || (ad == 0 && between(a, b, d)) || (ca == 0 && between(c, d, a)) ||
         (cb == 0 && between(c, d, b));
}

// Grows from a triangle, corner by corner, as long as no two edges touch.
Outline random_simple(std::mt19937& random, std::size_t corners, std::int64_t grid) {
  const auto any = [&] {
    return Point{static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(grid)),
                 static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(grid))};
  };
  Outline outline;
  do {
    outline = {any(), any(), any()};
  } while (twice_area(outline) == 0);
  for (int tried = 0; tried < 400 && outline.size() < corners; ++tried) {
    const std::size_t n = outline.size(), k = random() % n;
    const Point a = outline[k], b = outline[(k + 1) % n], p = any();
    bool touches = p == a || p == b;
    for (std::size_t m = 0; m < n && !touches; ++m) {
      const Point c = outline[m], d = outline[(m + 1) % n];
      if (m == k) continue;
      // Neighbours share an end; what else they share, they share with the other end of the new edge.
      touches = d == a ? share_a_point(c, d, p, p) || share_a_point(a, p, c, c) : share_a_point(a, p, c, d);
      touches =
          touches || (c == b ? share_a_point(c, d, p, p) || share_a_point(b, p, d, d) : share_a_point(p, b, c, d));
    }
    touches = touches || share_a_point(a, p, b, b) || share_a_point(p, b, a, a);
    if (!touches) outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(k + 1), p);
  }
  return outline;
}

TEST(Polygons, ThatAreConvexKeepTheirFans) {
  for (std::int64_t n = 3; n < 40; ++n) {
    Outline outline;  // a parabola, whose corners may also be on its chord
    for (std::int64_t k = 0; k < n; ++k) outline.push_back({k, k * k});
    ASSERT_TRUE(cut_polygon(in_space(outline)).empty());
    outline.push_back({(n - 1) / 2, (n - 1) * ((n - 1) / 2)});
    ASSERT_TRUE(cut_polygon(in_space(outline, {5, 5, 5}, {1, 2, 0}, {0, 1, 3})).empty());
  }
  // Seen from corner 0, all of an arrow is visible; seen from the next one, it is not.
  const Outline arrow{{0, 0}, {4, -3}, {9, 0}, {4, 3}}, blunt{{4, 3}, {0, 0}, {4, -3}, {2, 0}};
  EXPECT_TRUE(cut_polygon(in_space(arrow)).empty());
  EXPECT_EQ(cut_polygon(in_space(blunt)), (std::vector<Triangle>{{{3, 0, 1}}, {{3, 1, 2}}}));
}

TEST(Polygons, ThatAreSimpleAreCoveredOnce) {
  std::mt19937 random(11);
  std::size_t cut = 0;
  for (int k = 0; k < 1500; ++k) {
    const Outline outline = random_simple(random, 4 + random() % 16, k % 3 == 0 ? 6 : 40);
    ASSERT_NO_FATAL_FAILURE(expect_good_cut(outline)) << "polygon " << k;
    cut += !fan_is_right(outline);
  }
  EXPECT_GT(cut, 700u);
}

// Around a ring of cells, from the outline through a double edge to each hole.
Outline with_holes(std::int64_t holes) {
  Outline outline{{0, 0}, {10 * holes, 0}, {10 * holes, 10}, {0, 10}};
  for (std::int64_t k = holes; k-- > 0;) {
    const std::int64_t x = 10 * k + 3;
    const Outline hole{{x, 10}, {x, 7}, {x + 4, 7}, {x + 4, 4}, {x, 4}, {x, 7}, {x, 10}};
    outline.insert(outline.end() - 1, hole.begin(), hole.end());
  }
  return outline;
}

TEST(Polygons, WithHolesAtDoubleEdgesAreCoveredOnce) {
  for (const std::int64_t holes : {1, 2, 3, 10}) {
    const Outline outline = with_holes(holes);
    ASSERT_EQ(twice_area(outline), 2 * holes * (100 - 12));
    for (std::size_t first = 0; first < outline.size(); ++first) {
      Outline turned = outline;
      std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(first), turned.end());
      ASSERT_NO_FATAL_FAILURE(expect_covered_once(turned, cut_or_fan(in_space(turned)))) << holes << " " << first;
    }
  }
}

TEST(Polygons, ThatTouchThemselvesAreCoveredOnce) {
  const std::vector<Outline> outlines{
      {{0, 0}, {8, 0}, {8, 8}, {4, 0}, {0, 8}},                  // a corner on an edge
      {{0, 0}, {8, 0}, {4, 4}, {8, 8}, {0, 8}, {4, 4}},          // two triangles that meet in a corner
      {{0, 0}, {8, 0}, {8, 8}, {4, 4}, {4, 2}, {4, 4}, {0, 8}},  // a spike inwards
      {{0, 0}, {8, 0}, {8, 8}, {4, 4}, {4, 9}, {4, 4}, {0, 8}},  // and outwards
      {{0, 0}, {8, 0}, {8, 0}, {8, 8}, {4, 1}, {4, 1}, {0, 8}},  // repeated corners
      {{0, 0}, {0, 0}, {0, 0}, {8, 0}, {8, 8}, {4, 1}, {0, 8}}};
  for (const Outline& outline : outlines)
    for (std::size_t first = 0; first < outline.size(); ++first) {
      Outline turned = outline;
      std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(first), turned.end());
      ASSERT_NO_FATAL_FAILURE(expect_covered_once(turned, cut_or_fan(in_space(turned))))
          << &outline - outlines.data() << " from " << first;
    }
}

Outline spiral(std::int64_t corners) {
  Outline out, in;
  for (std::int64_t k = 0; k < corners / 2; ++k) {
    const double angle = 0.05 * static_cast<double>(k), radius = 1e6 + 2e4 * angle;
    const auto at = [&](double r) {
      return Point{std::llround(r * std::cos(angle)), std::llround(r * std::sin(angle))};
    };
    out.push_back(at(radius)), in.push_back(at(radius - 3e4));
  }
  out.insert(out.end(), in.rbegin(), in.rend());
  return out;
}

Outline star(std::int64_t corners) {
  Outline outline;
  for (std::int64_t k = 0; k < corners; ++k) {
    const double angle = 2 * std::acos(-1.0) * static_cast<double>(k) / static_cast<double>(corners);
    const double radius = k % 2 == 0 ? 1e8 : 1e7;
    outline.push_back({std::llround(radius * std::cos(angle)), std::llround(radius * std::sin(angle))});
  }
  return outline;
}

Outline comb(std::int64_t corners) {
  Outline outline{{0, 0}, {6 * corners, 0}};
  for (std::int64_t k = corners / 2 - 1; k > 0; --k)
    outline.insert(outline.end(), {{12 * k + 7, 90'000}, {12 * k, 9'000}});
  return outline;
}

Outline saw(std::int64_t corners) {  // teeth from two sides, into each other
  Outline low, high;
  for (std::int64_t k = 0; k < corners / 2; ++k) {
    low.push_back({10 * k, k % 2 == 0 ? 0 : 90'000});
    high.push_back({10 * k, k % 2 == 0 ? 10'000 : 100'000});
  }
  low.insert(low.end(), high.rbegin(), high.rend());
  return low;
}

Outline scribble(std::int64_t corners) {  // crosses itself everywhere
  std::mt19937 random(1);
  Outline outline;
  for (std::int64_t k = 0; k < corners; ++k)
    outline.push_back({static_cast<std::int64_t>(random() % 100'000), static_cast<std::int64_t>(random() % 100'000)});
  return outline;
}

TEST(Polygons, OfTenThousandCornersTakeWellUnderASecond) {
  for (const auto& [name, make] : std::map<std::string, std::function<Outline(std::int64_t)>>{
           {"spiral", spiral}, {"star", star}, {"comb", comb}, {"saw", saw}, {"scribble", scribble}}) {
    Outline outline = make(10'000);
    std::rotate(outline.begin(), outline.begin() + 1, outline.end());  // from a corner that sees little
    const std::vector<Vec3d> polygon = in_space(outline, {3, 4, 5}, {1, 1, 0}, {0, 1, 2});
    const std::clock_t begin = std::clock();
    const std::vector<Triangle> triangles = cut_polygon(polygon);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    EXPECT_LT(seconds, 1) << name;
    RecordProperty(name + "_seconds", std::to_string(seconds));
    if (name == "scribble") {
      ASSERT_NO_FATAL_FAILURE(expect_edges_of_outline(outline.size(), triangles));
    } else {
      ASSERT_NO_FATAL_FAILURE(expect_covered_once(outline, triangles)) << name;
    }
  }
}

TEST(Polygons, ThatAreNotQuitePlanarAreCutAsTheirShadows) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 300; ++k) {
    const Outline outline = random_simple(random, 12, 40);
    Vec3d u{unit(random), unit(random), unit(random)}, v{unit(random), unit(random), unit(random)};
    v = v - (dot(u, v) / dot(u, u)) * u;  // at right angles, so that the noise is small beside the polygon
    if (length(v) < 0.1 || length(u) < 0.1) continue;
    std::vector<Vec3d> polygon = in_space(outline, {100, 100, 100}, u, v);
    for (Vec3d& p : polygon) p = p + 1e-7 * Vec3d{unit(random), unit(random), unit(random)};
    const std::vector<Triangle> triangles = cut_or_fan(polygon);
    ASSERT_NO_FATAL_FAILURE(expect_edges_of_outline(outline.size(), triangles));
    double sum = 0;
    for (const Triangle& t : triangles)
      sum += length(cross(polygon[t.v[1]] - polygon[t.v[0]], polygon[t.v[2]] - polygon[t.v[0]]));
    const double whole = static_cast<double>(std::abs(twice_area(outline))) * length(cross(u, v));
    EXPECT_NEAR(sum, whole, 1e-4) << k;
  }
}

TEST(Polygons, OfAnyKindAreCutSomehow) {
  constexpr double infinite = std::numeric_limits<double>::infinity(), none = std::numeric_limits<double>::quiet_NaN();
  std::mt19937 random(3);
  std::vector<std::vector<Vec3d>> polygons{
      in_space({{0, 0}, {1, 1}, {1, 0}, {0, 1}}),                         // no area: a bow tie
      in_space({{0, 0}, {3, 3}, {1, 1}, {7, 7}, {2, 2}}, {}, {1, 2, 3}),  // on a line
      std::vector<Vec3d>(100, Vec3d{1, 2, 3}),                            // in a point
      in_space({{0, 0}, {9, 2}, {2, 9}, {1, 0}, {9, 9}}),                 // crosses itself
      {{0, 0, 0}, {1, 0, none}, {0.1, 0.1, 0}, {0, 1, 0}},
      {{0, 0, 0}, {infinite, 0, 0}, {0.1, 0.1, 0}, {0, 1, 0}}};
  for (int k = 0; k < 300; ++k) {  // cross themselves anyhow, many corners in one place
    Outline outline(4 + random() % 60);
    const std::uint64_t grid = 2 + random() % 9;
    for (Point& p : outline)
      p = {static_cast<std::int64_t>(random() % grid), static_cast<std::int64_t>(random() % grid)};
    polygons.push_back(in_space(outline));
  }
  for (const std::vector<Vec3d>& polygon : polygons)
    ASSERT_NO_FATAL_FAILURE(expect_edges_of_outline(polygon.size(), cut_or_fan(polygon)));
  const Outline arrow{{4, 3}, {0, 0}, {4, -3}, {2, 0}};
  for (const double size : {1e-320, 1e-300, 1e-150, 1e-30, 1e30, 1e150, 1e300})
    EXPECT_EQ(cut_polygon(in_space(arrow, {}, {size, 0, 0}, {0, size, 0})).size(), 2u) << size;
}

TEST(Polygons, AreReplacedAmongTrianglesWithTheValuesOfTheirCorners) {
  const std::vector<Vec3d> positions = in_space({{4, 3}, {0, 0}, {4, -3}, {2, 0}, {50, 50}});
  std::vector<Triangle> triangles{{{4, 4, 4}}, {{0, 1, 2}}, {{0, 2, 3}}, {{3, 2, 1}}, {{3, 1, 0}}, {{4, 0, 1}}};
  std::vector<Triangle> values{{{9, 9, 9}},    {{10, 11, 12}}, {{10, 12, 13}},
                               {{23, 22, 21}}, {{23, 21, 20}}, {{1, 2, 3}}};
  const std::vector<FanRun> runs{{.first = 1, .polygons = 2, .corners = 4}};
  cut_fans(positions, runs, triangles, std::array{std::span(values)});
  EXPECT_EQ(triangles,
            (std::vector<Triangle>{{{4, 4, 4}}, {{3, 0, 1}}, {{3, 1, 2}}, {{3, 2, 1}}, {{3, 1, 0}}, {{4, 0, 1}}}));
  EXPECT_EQ(values, (std::vector<Triangle>{
                        {{9, 9, 9}}, {{13, 10, 11}}, {{13, 11, 12}}, {{23, 22, 21}}, {{23, 21, 20}}, {{1, 2, 3}}}));
}

}  // namespace
}  // namespace lodestone
