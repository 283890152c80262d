// Cones of normals, closed surfaces, and the space outside of them: each against a brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "render/culling/back_faces.h"
#include "render/lod/morph.h"
#include "tests/naive_hierarchy.h"
#include "tests/render/conformance.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

using test::NaiveHierarchy;

const Hierarchy& sphere() {
  static const NaiveHierarchy small = test::naive_hierarchy(test::sphere_mesh(5), 4, 0.5f);
  return small.hierarchy;
}
const Hierarchy& torus() {
  static const NaiveHierarchy small = test::naive_hierarchy(test::torus_mesh(96, 48), 3, 0.5f);
  return small.hierarchy;
}

float number(std::mt19937& random, float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(random); }
Vec3f point(std::mt19937& random, float lo, float hi) {
  return {number(random, lo, hi), number(random, lo, hi), number(random, lo, hi)};
}

// Not negative: seen from behind.
double from_behind(Vec3d viewpoint, const std::array<Vec3d, 3>& p) {
  return dot(p[0] - viewpoint, cross(p[1] - viewpoint, p[2] - viewpoint));
}

// The basis of the cones: the minimum over all lambdas is found where each is 0 or 1.
TEST(NormalCones, EightStatesBoundAllMorphStates) {
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    std::array<Vec3d, 3> w, parent;
    for (std::size_t k = 0; k < 3; ++k)
      w[k] = to_double(point(random, 0, 1)), parent[k] = to_double(point(random, 0, 1));
    const Vec3d viewpoint = to_double(point(random, -1, 2));
    const auto at = [&](const std::array<double, 3>& lambda) {
      std::array<Vec3d, 3> n;
      for (std::size_t k = 0; k < 3; ++k) n[k] = lambda[k] * w[k] + (1 - lambda[k]) * parent[k];
      return from_behind(viewpoint, n);
    };
    double least = 1e9;
    for (unsigned s = 0; s < 8; ++s)
      least = std::min(least, at({double(s & 1), double(s >> 1 & 1), double(s >> 2 & 1)}));
    for (int k = 0; k < 50; ++k)
      EXPECT_GE(at({number(random, 0, 1), number(random, 0, 1), number(random, 0, 1)}), least - 1e-12);
  }
}

// Corners of a triangle with a lambda for each.
std::array<Vec3d, 3> morphed(const Hierarchy& h, const Cell& cell, const Triangle& t, std::array<float, 3> lambda) {
  std::array<Vec3d, 3> p;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d w = to_double(cell.positions[t.v[k]]);
    const Vec3d parent = cell.parent == no_cell ? w : to_double(h.cells[cell.parent].positions[cell.parents[t.v[k]]]);
    p[k] = double{lambda[k]} * w + (1.0 - double{lambda[k]}) * parent;
  }
  return p;
}

TEST(NormalCones, WhatTurnsItsBackIsSeenFromBehindInEveryMorphState) {
  const auto scheduler = make_serial_scheduler();
  std::mt19937 random(2);
  std::size_t still = 0, morphing = 0, subtrees = 0;
  for (const Hierarchy* h : {&sphere(), &torus()}) {
    const NormalCones cones(*h, *scheduler);
    for (int i = 0; i < 40; ++i) {
      const Vec3f viewpoint = point(random, -2, 3);
      for (CellId c{0}; c < h->cells.size(); ++c) {
        const Cell& cell = h->cells[c];
        const Box3f box = drawn_bounds(*h, c, h->level_of(c));
        const auto expect_behind = [&](bool any_lambda) {
          for (const Triangle& t : cell.triangles)
            for (int k = 0; k < (any_lambda ? 6 : 1); ++k) {
              std::array<float, 3> lambda{1, 1, 1};
              if (any_lambda)
                for (float& l : lambda) l = std::clamp(number(random, -0.5f, 1.5f), 0.0f, 1.0f);
              ASSERT_GE(from_behind(to_double(viewpoint), morphed(*h, cell, t, lambda)), -1e-13);
            }
        };
        if (turns_its_back(cones.still(c), viewpoint, box)) ++still, expect_behind(false);
        if (turns_its_back(cones.morphing(c), viewpoint, box)) ++morphing, expect_behind(true);
        if (!turns_its_back(cones.subtree(c), viewpoint, box)) continue;
        ++subtrees;
        EXPECT_TRUE(turns_its_back(cones.morphing(c), viewpoint, box));
        for (CellId below = cell.first_child; below < cell.end_child(); ++below)
          EXPECT_TRUE(turns_its_back(cones.morphing(below), viewpoint, drawn_bounds(*h, below, h->level_of(below))));
      }
    }
  }
  EXPECT_GT(still, 500u);
  EXPECT_GT(morphing, 50u);
  EXPECT_GT(subtrees, 50u);
}

// A cell of the builder's with hardly any curvature: the cone is hardly wider than its normals are apart.
TEST(NormalCones, AreAsNarrowAsTheSurfaceIsFlat) {
  const auto scheduler = make_serial_scheduler();
  const NaiveHierarchy flat = test::naive_hierarchy(test::terrain_mesh(32, 0), 2, 0.5f);
  const NormalCones cones(flat.hierarchy, *scheduler);
  for (CellId c{0}; c < flat.hierarchy.cells.size(); ++c) {
    EXPECT_LT(cones.still(c).sine, 0.01f);
    EXPECT_NEAR(std::abs(cones.still(c).axis.z), 1, 1e-5);
  }
  EXPECT_TRUE(turns_its_back(cones.still(CellId(0)), {0.5f, 0.5f, -5}, flat.hierarchy.cells[0].bounds));
  EXPECT_FALSE(turns_its_back(cones.still(CellId(0)), {0.5f, 0.5f, 5}, flat.hierarchy.cells[0].bounds));
  EXPECT_FALSE(turns_its_back(cones.still(CellId(0)), {5, 0.5f, 0}, flat.hierarchy.cells[0].bounds)) << "from the side";
}

TEST(NormalCones, SameForAnyNumberOfThreads) {
  const NormalCones serial(torus(), *make_serial_scheduler()), parallel(torus(), *make_tbb_scheduler(3));
  for (CellId c{0}; c < torus().cells.size(); ++c) {
    EXPECT_EQ(serial.still(c).axis, parallel.still(c).axis);
    EXPECT_EQ(serial.still(c).sine, parallel.still(c).sine);
    EXPECT_EQ(serial.subtree(c).sine, parallel.subtree(c).sine);
  }
}

IndexedMesh turned_over(IndexedMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t.v[0], t.v[1]);
  return mesh;
}

IndexedMesh both(const IndexedMesh& a, const IndexedMesh& b, Vec3f shift, float scale) {
  IndexedMesh all = a;
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  for (const auto& p : b.positions) all.positions.push_back(scale * p + shift);
  for (const Triangle& t : b.triangles) all.triangles.push_back({{first + t.v[0], first + t.v[1], first + t.v[2]}});
  return all;
}

TEST(BackFaces, ClosedSurfacesAndTheirSidesAreKnown) {
  const auto scheduler = make_tbb_scheduler(2);
  const auto facing = [&](IndexedMesh mesh) {
    return facing_of(test::naive_hierarchy(std::move(mesh), 2, 0.5f).hierarchy, *scheduler);
  };
  const IndexedMesh sphere = test::sphere_mesh(3), inside_out = turned_over(sphere);
  EXPECT_EQ(facing(sphere), Facing::outward);
  EXPECT_EQ(facing(test::torus_mesh(24, 12)), Facing::outward);
  EXPECT_EQ(facing(test::terrain_mesh(16)), Facing::open);
  EXPECT_EQ(facing(inside_out), Facing::inward);
  EXPECT_EQ(facing(both(sphere, sphere, {3, 0, 0}, 1)), Facing::outward);
  EXPECT_EQ(facing(both(inside_out, inside_out, {3, 0, 0}, 1)), Facing::inward);
  EXPECT_EQ(facing(both(sphere, inside_out, {3, 0, 0}, 0.5)), Facing::mixed) << "one beside the other";
  EXPECT_EQ(facing(both(sphere, inside_out, {0, 0, 0}, 1)), Facing::mixed) << "no volume";
  IndexedMesh hole = sphere;
  hole.triangles.pop_back();
  EXPECT_EQ(facing(hole), Facing::open);
  IndexedMesh flipped = sphere;
  std::swap(flipped.triangles[7].v[0], flipped.triangles[7].v[1]);
  EXPECT_EQ(facing(flipped), Facing::open);
  EXPECT_EQ(facing_of({}, *scheduler), Facing::open);
  EXPECT_FALSE(is_closed({}, *scheduler));
  EXPECT_TRUE(
      is_closed(test::naive_hierarchy(both(sphere, inside_out, {3, 0, 0}, 0.5), 2, 0.5f).hierarchy, *scheduler));
}

// Solid angle of the surface, over 4 pi (vanoosterom1983).
double winding_number(const Hierarchy& h, Vec3f from) {
  double sum = 0;
  for (const Cell& cell : h.cells_of(h.finest()))
    for (const Triangle& t : cell.triangles) {
      const Vec3d a = to_double(cell.positions[t.v[0]]) - to_double(from),
                  b = to_double(cell.positions[t.v[1]]) - to_double(from),
                  c = to_double(cell.positions[t.v[2]]) - to_double(from);
      const double la = length(a), lb = length(b), lc = length(c);
      sum += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
  return sum / (4 * std::numbers::pi);
}

TEST(BackFaces, WhatIsCalledOutsideIsOutside) {
  std::mt19937 random(3);
  for (const Hierarchy* h : {&sphere(), &torus()}) {
    const OutsideSpace outside(*h);
    std::size_t within_the_cube = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3f p = point(random, -0.2f, 1.2f);
      if (!outside.contains(p)) continue;
      const auto in = [](float v) { return v > 0 && v < 1; };
      within_the_cube += in(p.x) && in(p.y) && in(p.z);
      EXPECT_NEAR(winding_number(*h, p), 0, 1e-6);
    }
    EXPECT_GT(within_the_cube, 10u);
  }
  EXPECT_FALSE(OutsideSpace(sphere()).contains({0.5f, 0.5f, 0.5f}));
  EXPECT_FALSE(OutsideSpace(sphere()).contains({NAN, 0.5f, 0.5f}));
  EXPECT_TRUE(OutsideSpace(torus()).contains({0.5f, 0.5f, -1}));
  EXPECT_FALSE(OutsideSpace({}).contains({0, 0, 0}));
}

// A vertex may be anywhere within its reach of a cell's box.
TEST(BackFaces, ThePlacesThatTheSurfaceMayEnterAreNotOutside) {
  for (const Hierarchy* h : {&sphere(), &torus()}) {
    const OutsideSpace outside(*h);
    const float margin = 0.999f * (displacement_bound(h->sigma0, h->finest()) + OutsideSpace::clearance);
    for (const Cell& cell : h->cells_of(h->finest()))
      for (unsigned corner = 0; corner < 8; ++corner) {
        const Vec3f &lo = cell.bounds.lo, &hi = cell.bounds.hi;
        const Vec3f p{corner & 1 ? hi.x + margin : lo.x - margin, corner & 2 ? hi.y + margin : lo.y - margin,
                      corner & 4 ? hi.z + margin : lo.z - margin};
        const auto in = [](float v) { return v > 0 && v < 1; };
        EXPECT_FALSE(in(p.x) && in(p.y) && in(p.z) && outside.contains(p));
      }
  }
}

// The bottom of a bowl is reached from its open side alone, whichever that is.
TEST(BackFaces, OutsideReachesIntoBowlsFromEverySide) {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upward : {false, true}) {
      IndexedMesh bowl = test::sphere_mesh(5);
      std::erase_if(bowl.triangles, [&](const Triangle& t) {
        const Vec3f p = bowl.positions[t.v[0]];
        const float along = axis == 0 ? p.x : axis == 1 ? p.y : p.z;
        return upward ? along > 0.5f : along < 0.5f;
      });
      const NaiveHierarchy small = test::naive_hierarchy(bowl, 4, 0.5f);
      const float bottom = upward ? 0.25f : 0.75f;
      const Vec3f within{axis == 0 ? bottom : 0.5f, axis == 1 ? bottom : 0.5f, axis == 2 ? bottom : 0.5f};
      EXPECT_TRUE(OutsideSpace(small.hierarchy).contains(within)) << "axis " << axis << ", upward " << upward;
    }
}

TEST(BackFaces, AreDrawnWhereTheyCanBeSeen) {
  const auto scheduler = make_serial_scheduler();
  const Vec3f away{3, 0, 0};
  const BackFaces closed(sphere(), *scheduler);
  EXPECT_NE(closed.cones_from(away, {}), nullptr);
  EXPECT_EQ(closed.cones_from({0.5f, 0.5f, 0.5f}, {}), nullptr) << "from inside";
  EXPECT_EQ(closed.cones_from(away, {.opacity = 0.5f}), nullptr) << "glass";
  const NaiveHierarchy terrain = test::naive_hierarchy(test::terrain_mesh(16), 1, 0.5f);
  EXPECT_EQ(BackFaces(terrain.hierarchy, *scheduler).cones_from(away, {}), nullptr) << "open";

  NaiveHierarchy inward = test::naive_hierarchy(turned_over(test::sphere_mesh(5)), 2, 0.5f);
  EXPECT_NE(BackFaces(inward.hierarchy, *scheduler).cones_from(away, {}), nullptr);
  inward.hierarchy.materials.emplace_back().double_sided = false;
  EXPECT_EQ(BackFaces(inward.hierarchy, *scheduler).cones_from(away, {}), nullptr) << "its outer side is not drawn";
  Hierarchy lace = sphere();
  lace.materials.emplace_back().alpha_mode = AlphaMode::mask;
  EXPECT_EQ(BackFaces(lace, *scheduler).cones_from(away, {}), nullptr) << "through the holes";
  EXPECT_NE(BackFaces(lace, *scheduler).cones_from(away, {.textures = false}), nullptr);
}

TEST(Selection, CullsByConesWhatTurnsItsBackAlone) {
  const auto scheduler = make_serial_scheduler();
  const NormalCones cones(sphere(), *scheduler);
  std::mt19937 random(4);
  std::size_t culled = 0;
  Selection all, listed, left_out;
  for (int i = 0; i < 60; ++i) {
    RadiiConfig config;
    config.kappa0 = number(random, 0.3f, 5);
    const Radii radii = make_radii(sphere(), config);
    const MorphContext morph{&sphere(), &radii, Blend::early, point(random, -1, 2)};
    select_cells(sphere(), radii, morph.viewpoint, {}, all);
    select_cells(sphere(), radii, morph.viewpoint, {.cones = &cones}, listed);
    select_cells(sphere(), radii, morph.viewpoint, {.keep_culled = false, .cones = &cones}, left_out);
    ASSERT_EQ(listed.cells.size(), all.cells.size());
    std::vector<CellId> visible, kept;
    for (std::size_t k = 0; k < all.cells.size(); ++k) {
      const SelectedCell& s = listed.cells[k];
      ASSERT_EQ(s.cell, all.cells[k].cell);
      if (s.visible) {
        visible.push_back(s.cell);
        continue;
      }
      ++culled;
      const Cell& cell = sphere().cells[s.cell];
      std::vector<Vec3f> p(cell.positions.size());
      morph_cell(morph, s.cell, p);
      for (const Triangle& t : cell.triangles)
        ASSERT_GE(
            from_behind(to_double(morph.viewpoint), {to_double(p[t.v[0]]), to_double(p[t.v[1]]), to_double(p[t.v[2]])}),
            -1e-12);
    }
    for (const SelectedCell& s : left_out.cells) kept.push_back(s.cell);
    EXPECT_EQ(kept, visible);
  }
  EXPECT_GT(culled, 500u);
}

}  // namespace
}  // namespace lodestone
