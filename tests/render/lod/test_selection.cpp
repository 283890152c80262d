// Selection: a partition of the finest mesh, equal to its definition; culling loses nothing that is seen.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "core/hierarchy/model/distance_metric.h"
#include "render/camera/camera.h"
#include "render/lod/morph.h"
#include "render/lod/selection.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

using test::NaiveHierarchy;

const NaiveHierarchy& torus() {
  static const NaiveHierarchy small = test::naive_hierarchy(test::torus_mesh(96, 48), 4);
  return small;
}

const NaiveHierarchy& terrain() {
  static const NaiveHierarchy small = test::naive_hierarchy(test::terrain_mesh(48), 3);
  return small;
}

Radii radii_of(const Hierarchy& h, float kappa0, DistanceMetric metric = DistanceMetric::euclidean) {
  RadiiConfig config;
  config.kappa0 = kappa0;
  config.metric = metric;
  return make_radii(h, config);
}

Vec3f random_point(std::mt19937& random, float lo, float hi) {
  std::uniform_real_distribution<float> along(lo, hi);
  return {along(random), along(random), along(random)};
}

// The definition, upwards from a finest cell: of its ancestors and itself the coarsest one that may be drawn.
CellId drawn_ancestor(const Hierarchy& h, const Radii& radii, Vec3f viewpoint, CellId finest_cell) {
  CellId drawn = finest_cell;
  for (CellId c = finest_cell; c != no_cell; c = h.cells[c].parent)
    if (c == finest_cell ||
        distance(radii.metric, viewpoint, h.cells[c].bounds) >= radii.select[static_cast<std::size_t>(h.level_of(c))])
      drawn = c;
  return drawn;
}

std::set<CellId> cells_of(const Selection& selection) {
  std::set<CellId> cells;
  for (const SelectedCell& s : selection.cells) EXPECT_TRUE(cells.insert(s.cell).second) << "listed twice";
  return cells;
}

TEST(Selection, IsItsDefinitionAndAPartition) {
  std::mt19937 random(1);
  const Hierarchy& h = torus().hierarchy;
  Selection selection;
  for (int i = 0; i < 300; ++i) {
    const auto metric = i % 2 ? DistanceMetric::euclidean : DistanceMetric::chebyshev;
    const Radii radii = radii_of(h, std::uniform_real_distribution<float>(0.1f, 6.0f)(random), metric);
    const Vec3f viewpoint = random_point(random, i % 3 ? -0.5f : 0.2f, i % 3 ? 1.5f : 0.8f);
    select_cells(h, radii, viewpoint, {}, selection);
    const std::set<CellId> selected = cells_of(selection);
    std::set<CellId> expected;
    for (CellId c = h.levels.back().first_cell; c < h.cells.size(); ++c) {
      expected.insert(drawn_ancestor(h, radii, viewpoint, c));
      int drawn_above = 0;
      for (CellId a = c; a != no_cell; a = h.cells[a].parent) drawn_above += static_cast<int>(selected.count(a));
      EXPECT_EQ(drawn_above, 1) << "cell " << c;
    }
    EXPECT_EQ(selected, expected);
    for (const SelectedCell& s : selection.cells) {
      EXPECT_EQ(s.level, h.level_of(s.cell));
      EXPECT_TRUE(s.visible);
    }
    EXPECT_GE(selection.visited, selection.cells.size());
  }
}

TEST(Selection, FarAwayIsTheRootAndOnTheSurfaceTheFinestIsThere) {
  const Hierarchy& h = torus().hierarchy;
  const Radii radii = radii_of(h, 2);
  Selection selection;
  select_cells(h, radii, {100, 100, 100}, {}, selection);
  ASSERT_EQ(selection.cells.size(), 1u);
  EXPECT_EQ(selection.cells[0].cell, 0u);
  select_cells(h, radii, h.cells.back().positions[0], {}, selection);
  EXPECT_TRUE(std::ranges::any_of(selection.cells, [&](const SelectedCell& s) { return s.level == h.finest(); }));
}

TEST(Selection, StaticCellsHaveLambdaOneEverywhere) {
  std::mt19937 random(2);
  const Hierarchy& h = terrain().hierarchy;
  Selection selection;
  std::size_t still = 0;
  for (int i = 0; i < 60; ++i) {
    const Radii radii = radii_of(h, 0.5f + static_cast<float>(i % 7));
    const MorphContext morph{&h, &radii, Blend::smoothstep, random_point(random, -0.2f, 1.2f)};
    select_cells(h, radii, morph.viewpoint, {}, selection);
    for (const SelectedCell& s : selection.cells) {
      if (s.morphing) continue;
      ++still;
      for (const Vec3f p : h.cells[s.cell].positions) EXPECT_EQ(morph_lambda(morph, s.level, p), 1);
    }
  }
  EXPECT_GT(still, 100u) << "hardly any static cell was met: the test says nothing";
}

// True if any part of the triangle is inside all planes. By clipping the triangle itself, in double.
bool seen(const Frustum& frustum, const std::array<Vec3f, 3>& triangle) {
  std::vector<Vec3d> polygon;
  for (const Vec3f p : triangle) polygon.push_back(to_double(p));
  for (const Plane& plane : frustum) {
    std::vector<Vec3d> kept;
    const auto side = [&](Vec3d p) { return dot(to_double(plane.n), p) + plane.d; };
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      if (side(a) >= 0) kept.push_back(a);
      if ((side(a) < 0) != (side(b) < 0)) kept.push_back(a + (side(a) / (side(a) - side(b))) * (b - a));
    }
    polygon = std::move(kept);
  }
  return !polygon.empty();
}

TEST(Selection, CullingIsConservativeAndCulls) {
  std::mt19937 random(3);
  const Hierarchy& h = torus().hierarchy;
  Selection selection;
  std::size_t culled = 0;
  for (int i = 0; i < 80; ++i) {
    Camera camera;
    camera.position = h.transform.to_model(random_point(random, -0.3f, 1.3f));
    camera.target = h.transform.to_model(random_point(random, 0.0f, 1.0f));
    camera.vertical_fov = std::uniform_real_distribution<double>(0.05, 1.5)(random);
    const Radii radii = radii_of(h, std::uniform_real_distribution<float>(0.1f, 4.0f)(random));
    const MorphContext morph{&h, &radii, Blend::linear, viewpoint(camera, h.transform)};
    const Frustum frustum = frustum_of(view_projection(camera, h, {320, 200}));
    select_cells(h, radii, morph.viewpoint, {&frustum, true}, selection);
    std::vector<Vec3f> positions;
    for (const SelectedCell& s : selection.cells) {
      if (s.visible) continue;
      ++culled;
      const Cell& cell = h.cells[s.cell];
      positions.resize(cell.positions.size());
      morph_cell(morph, s.cell, positions);
      for (const Triangle& t : cell.triangles)
        ASSERT_FALSE(seen(frustum, {positions[t.v[0]], positions[t.v[1]], positions[t.v[2]]})) << "view " << i;
    }
  }
  EXPECT_GT(culled, 1000u);
}

// Morphed vertices leave the bounds of their cell. Half-spaces that hold such a vertex and nothing of the bounds.
TEST(Selection, CellsWhoseMorphedVerticesAreInViewAreVisible) {
  std::mt19937 random(4);
  const Hierarchy& h = torus().hierarchy;
  const Radii radii = radii_of(h, 1);
  std::size_t met = 0;
  for (int i = 0; i < 20; ++i) {
    const MorphContext morph{&h, &radii, Blend::early, random_point(random, -0.3f, 1.3f)};
    Selection whole, culled;
    select_cells(h, radii, morph.viewpoint, {}, whole);
    for (const SelectedCell& s : whole.cells) {
      const Cell& cell = h.cells[s.cell];
      std::vector<Vec3f> positions(cell.positions.size());
      morph_cell(morph, s.cell, positions);
      const auto top = std::ranges::max_element(positions, {}, &Vec3f::z);
      if (top->z <= cell.bounds.hi.z) continue;
      ++met;
      Frustum above;
      above.fill({{0, 0, 0}, 1});
      above[0] = {{0, 0, 1}, -top->z};
      select_cells(h, radii, morph.viewpoint, {&above, false}, culled);
      EXPECT_TRUE(std::ranges::any_of(culled.cells, [&](const SelectedCell& c) { return c.cell == s.cell; }));
    }
  }
  EXPECT_GT(met, 20u) << "hardly any vertex left its bounds: the test says nothing";
}

TEST(Selection, LeavingCulledCellsOutChangesNothingElse) {
  const Hierarchy& h = torus().hierarchy;
  const Radii radii = radii_of(h, 3);
  Camera camera{h.transform.to_model({0.1f, 0.1f, 0.3f}), h.transform.to_model({0.9f, 0.5f, 0.1f})};
  const Frustum frustum = frustum_of(view_projection(camera, h, {320, 200}));
  Selection all, visible, unculled;
  const Vec3f from = viewpoint(camera, h.transform);
  select_cells(h, radii, from, {&frustum, true}, all);
  select_cells(h, radii, from, {&frustum, false}, visible);
  select_cells(h, radii, from, {}, unculled);
  EXPECT_EQ(cells_of(all), cells_of(unculled));
  std::vector<CellId> a, b;
  for (const SelectedCell& s : all.cells)
    if (s.visible) a.push_back(s.cell);
  for (const SelectedCell& s : visible.cells) b.push_back(s.cell);
  EXPECT_EQ(a, b);
  EXPECT_LT(b.size(), all.cells.size());
  EXPECT_LT(visible.visited, all.visited);
}

TEST(Selection, EmptyHierarchySelectsNothing) {
  Selection selection;
  selection.cells.resize(3);
  select_cells({}, {}, {}, {}, selection);
  EXPECT_TRUE(selection.cells.empty());
}

// d(v, B) <= d(v, x) for x in B, in float, bit for bit: the proof rests on it.
RC_GTEST_PROP(Distance, ToABoxIsNeverMoreThanToAPointInIt, ()) {
  const auto coordinate = [] {
    const int kind = *rc::gen::inRange(0, 3);
    const float fine = static_cast<float>(*rc::gen::arbitrary<std::int32_t>()) * 0x1p-31f;
    return kind == 0 ? fine : kind == 1 ? fine * 1e-4f : fine * 4096;
  };
  const auto point = [&] { return Vec3f{coordinate(), coordinate(), coordinate()}; };
  Box3f box;
  box.extend(point());
  box.extend(point());
  const Vec3f viewpoint = point();
  const auto inside = [&](float lo, float hi) {
    const float t = static_cast<float>(*rc::gen::inRange(0, 1025)) / 1024;
    return std::clamp(lo + t * (hi - lo), lo, hi);
  };
  const Vec3f x{inside(box.lo.x, box.hi.x), inside(box.lo.y, box.hi.y), inside(box.lo.z, box.hi.z)};
  for (const DistanceMetric metric : {DistanceMetric::euclidean, DistanceMetric::chebyshev}) {
    RC_ASSERT(distance(metric, viewpoint, box) <= distance(metric, viewpoint, x));
    RC_ASSERT(distance(metric, viewpoint, x) <= farthest_corner_distance(metric, viewpoint, box));
  }
}

}  // namespace
}  // namespace lodestone
