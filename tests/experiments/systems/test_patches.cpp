// Common parts of systems that make levels of their own: cells of meshes, jumps of points, borders that move.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "experiments/systems/patch_proof.h"
#include "experiments/systems/place_jumps.h"
#include "experiments/systems/surface/patch_hierarchy.h"
#include "experiments/systems/surface/surface_distance.h"
#include "experiments/systems/system_pictures.h"
#include "tests/experiments/systems/system_models.h"

namespace lodestone {
namespace {

using namespace testing;

std::vector<std::array<Vec3f, 3>> triangles_in(const Hierarchy& hierarchy, const std::vector<CellId>& cells) {
  std::vector<std::array<Vec3f, 3>> all;
  for (const CellId c : cells)
    for (const Triangle& t : hierarchy.cells[c].triangles) {
      const auto at = [&](std::uint32_t v) { return hierarchy.cells[c].positions[v]; };
      all.push_back({at(t.v[0]), at(t.v[1]), at(t.v[2])});
    }
  return all;
}

TEST(PatchHierarchy, CutsAMeshIntoCells) {
  const WeldedSurface surface = welded_surface(torus(), "test");
  PatchHierarchy patches(torus());
  EXPECT_EQ(patches.hierarchy().cells.front().bounds, torus().cells.front().bounds);
  const CellId whole = patches.add({surface.positions, surface.normals, surface.triangles});
  const auto expected = triangles_in(patches.hierarchy(), {whole});
  EXPECT_EQ(expected.size(), surface.triangles.size());
  for (const std::size_t run : {100u, 2048u, 1000000u}) {
    const std::vector<CellId> cells = patches.remake({surface.positions, surface.normals, surface.triangles}, run);
    EXPECT_EQ(cells.size(), (surface.triangles.size() + run - 1) / run);
    EXPECT_EQ(patches.hierarchy().levels.front().triangles, surface.triangles.size());
    EXPECT_EQ(triangles_in(patches.hierarchy(), cells), expected);
    for (const CellId c : cells)
      for (const Vec3f p : patches.hierarchy().cells[c].positions)
        EXPECT_TRUE(patches.hierarchy().cells[c].bounds.contains(p));
  }
  patches.clear();
  EXPECT_EQ(patches.hierarchy().cells.size(), 1u);
}

TEST(PatchHierarchy, HasIndicesOf32BitsWhere16DoNotSuffice) {
  std::vector<Vec3f> positions;
  for (int i = 0; i < 70000; ++i) positions.push_back({static_cast<float>(i), 0, static_cast<float>(i % 2)});
  const std::vector<PackedNormal> normals(positions.size());
  const std::vector<Triangle> triangles{{{0, 1, 69999}}};
  PatchHierarchy patches(torus());
  const CellId cell = patches.add({positions, normals, triangles});
  EXPECT_FALSE(patches.hierarchy().cells[cell].triangles.is_short());
  EXPECT_EQ(triangles_in(patches.hierarchy(), {cell}).front()[2].x, 69999);
  const std::vector<CellId> cells = patches.remake({positions, normals, triangles});
  EXPECT_TRUE(patches.hierarchy().cells[cells.front()].triangles.is_short());
  SystemModel model;
  model.hierarchy = &patches.hierarchy();
  model.whole.cells.push_back({.cell = cells.front()});
  EXPECT_EQ(drawn_bytes(model), 3 * (sizeof(Vec3f) + sizeof(PackedNormal)) + 3 * sizeof(std::uint16_t));
}

TEST(CoherentOrder, KeepsAllTriangles) {
  const WeldedSurface surface = welded_surface(torus(), "test");
  std::vector<std::uint32_t> order = coherent_order(surface.positions, surface.triangles);
  double apart = 0;
  const auto at = [&](std::uint32_t t) { return surface.positions[surface.triangles[t].v[0]]; };
  for (std::size_t i = 1; i < order.size(); ++i) apart += double{length(at(order[i]) - at(order[i - 1]))};
  EXPECT_LT(apart / static_cast<double>(order.size()), 0.05);
  std::ranges::sort(order);
  for (std::uint32_t t = 0; t < order.size(); ++t) EXPECT_EQ(order[t], t);
  EXPECT_EQ(order.size(), surface.triangles.size());
  EXPECT_EQ(normals_at(surface, surface.positions), surface.normals);
}

TEST(SurfaceDistance, IsTheLargestOfBothWays) {
  const std::vector<Vec3f> full{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5f, 0.5f, 0.25f}};
  const std::vector<Triangle> fine{{{0, 1, 3}}, {{0, 3, 2}}}, flat{{{0, 1, 2}}};
  const auto scheduler = make_serial_scheduler();
  const SurfaceView coarse{std::span(full).first(3), flat};
  const double upwards = surface_distance(coarse, full, tree_of({full, fine}), *scheduler);
  EXPECT_NEAR(upwards, 0.25, 1e-12) << "the vertex that is missing";
  EXPECT_EQ(surface_distance({full, fine}, full, tree_of({full, fine}), *scheduler), 0);
}

TEST(PlaceJumps, AreThoseOfThePoints) {
  PlacedFrame before{std::vector<Vec3f>(200, Vec3f{0, 0, 0}), {0, 0, 3}}, after = before;
  after.viewpoint = {0, 0, 2.5f};
  after.places[7] = {0.25f, 0, 0};
  after.places[8] = {0, 0.5f, 0};
  after.places[9] = {0, 0.125f, 0};
  ViewProjection orthographic;
  orthographic.m = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const JumpSample jump = place_jumps(before, after, Screen(orthographic, {200, 100}));
  EXPECT_EQ(jump.largest, 50);
  EXPECT_EQ(jump.p99.value(), 12.5) << "two points of 200 are beyond it";
  EXPECT_EQ(jump.pixels, 25);
  EXPECT_EQ(jump.step, 50);
  EXPECT_EQ(jump.per_step.value(), 1);
  EXPECT_FALSE(jump.over_bound);
}

TEST(PatchProof, ExpectsBordersWhereTheirPointsAreDrawn) {
  const auto scheduler = make_serial_scheduler();
  DrawnMesh moved;
  const WeldedSurface field = welded_surface(terrain(), "test");
  const PatchProof proof(to_drawn(field.positions, field.triangles), 1e-6, *scheduler);
  DrawnPoints points{field.positions, field.positions};
  for (Vec3f& p : points.places) p.z += 0.01f;
  moved = to_drawn(points.places, field.triangles);
  const Screen screen({}, {16, 16});
  EXPECT_EQ(proof.measure({moved, {}, points}, screen, {}).open_edges, 0u);
  EXPECT_EQ(proof.measure({moved, {}, {}}, screen, {}).open_edges, 2u * (149 + 100));
}

// Tolerances hold in the corners of the picture, where a step is seen as larger than in the middle. While the camera comes
// nearer, steps get smaller, which moves a model that stays aside.
TEST(KnownStep, PopsByTheToleranceAndNothingElse) {
  for (const float pixels : {0.25f, 1.0f, 4.0f}) {
    std::size_t steps = 0, rests = 0;
    double visible = 0;
    for (const SystemRow& row : fly(torus(), {"known-step"}, pixels, 12)) {
      EXPECT_EQ(row.surface.value().open_edges, 0u);
      EXPECT_EQ(row.surface->t_junctions.value(), 0u);
      EXPECT_LE(row.screen_error.value(), 1.01 * pixels);
      if (!row.surface->jump) continue;
      const double jump = row.surface->jump->pixels;
      EXPECT_LE(jump, 1.01 * pixels);
      if (jump > 0.5 * pixels) visible = std::max(visible, row.pops.value().visible.max);
      (jump > 0.5 * pixels ? steps : rests) += 1;
      EXPECT_TRUE(jump > 0.5 * pixels || jump < 0.2 * pixels) << jump;
    }
    EXPECT_GT(std::min(steps, rests), 1u);
    EXPECT_GT(visible, 1);
  }
}

}  // namespace
}  // namespace lodestone
