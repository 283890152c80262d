// Inputs of many more triangles than pixels: what is asked of their connectivity and of their visibility, against slow
// twins and closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <tuple>

#include "core/math/vec3.h"
#include "render/reconstruct/finish/label_parts.h"
#include "render/reconstruct/finish/survey.h"
#include "render/reconstruct/views/choose_views.h"
#include "render/reconstruct/views/coarse_copy.h"
#include "tests/render/reconstruct/edit_meshes.h"
#include "tests/test_meshes.h"

namespace lodestone::test {
namespace {

void expect_twins_agree(const IndexedMesh& mesh) {
  const Survey found = survey(mesh);
  EXPECT_EQ(found.census, count_edges(mesh.triangles, mesh.positions.size()));
  const bool is_surface = found.census.non_manifold + found.census.inconsistent == 0;
  EXPECT_EQ(found.handles, is_surface ? count_handles(mesh) : std::nullopt);
}

TEST(Survey, AgreesWithItsTwins) {
  EXPECT_EQ(survey(torus_mesh(12, 8)).handles, 1u);
  EXPECT_EQ(survey(touching(torus_mesh(12, 8))).handles, 2u);
  expect_twins_agree(mesh_of({}, 0));
  expect_twins_agree(sphere_mesh(3));
  expect_twins_agree(terrain_mesh(9));
  expect_twins_agree(touching(terrain_mesh(4)));
  expect_twins_agree(mesh_of({{{0, 1, 2}}, {{0, 1, 3}}}, 4));               // facing both ways
  expect_twins_agree(mesh_of({{{0, 1, 2}}, {{1, 0, 3}}, {{1, 0, 4}}}, 5));  // three at an edge
  std::vector<Triangle> fan;  // more triangles round a vertex than are looked at one by one
  for (std::uint32_t k = 1; k <= 1000; ++k) fan.push_back({{0, k, k % 1000 + 1}});
  expect_twins_agree(mesh_of(fan, 1001));
  IndexedMesh torus = torus_mesh(9, 7);
  for (std::mt19937 random(5); torus.triangles.size() > 3;) {  // holes, pinched vertices, pieces
    expect_twins_agree(torus);
    torus.triangles.erase(torus.triangles.begin() + static_cast<std::ptrdiff_t>(random() % torus.triangles.size()));
  }
}

TEST(Survey, WedgesAndDegenerateTrianglesDoNotCount) {
  IndexedMesh mesh = torus_mesh(9, 7);
  const Survey expected = survey(mesh);
  const auto count = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t v = 0; v < count; ++v) mesh.wedges.vertex.push_back(v);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {  // with vertices of its own
    for (std::uint32_t& v : mesh.triangles[t].v) {
      mesh.positions.push_back(mesh.positions[v]);
      mesh.wedges.vertex.push_back(v);
      v = static_cast<std::uint32_t>(mesh.positions.size() - 1);
    }
  }
  mesh.triangles.push_back({{0, 0, 1}});
  EXPECT_EQ(survey(mesh).census, expected.census);
  EXPECT_EQ(survey(mesh).handles, expected.handles);
}

using Cell = std::tuple<int, int, int>;
Cell cell_of(Vec3f p, double cell) {
  const auto step = [cell](float v) { return static_cast<int>(std::floor(v / cell)); };
  return {step(p.x), step(p.y), step(p.z)};
}

TEST(CoarseCopy, HasOneVertexForACellAtTheMeanOfItsOwn) {
  const IndexedMesh mesh = sphere_mesh(5);
  const double cell = 1.0 / 16;
  std::map<Cell, std::pair<Vec3d, int>> cells;
  for (const Vec3f p : mesh.positions) {
    auto& [sum, count] = cells[cell_of(p, cell)];
    sum = sum + to_double(p), ++count;
  }
  const IndexedMesh copy = coarse_copy(mesh, cell);
  ASSERT_EQ(copy.positions.size(), cells.size());
  std::map<Cell, Vec3f> means;
  for (const auto& [key, own] : cells) means[key] = to_float((1.0 / own.second) * own.first);
  std::size_t kept = 0;
  for (const Triangle& t : mesh.triangles) {
    const Cell a = cell_of(mesh.positions[t.v[0]], cell), b = cell_of(mesh.positions[t.v[1]], cell),
               c = cell_of(mesh.positions[t.v[2]], cell);
    if (a == b || b == c || c == a) continue;
    ASSERT_LT(kept, copy.triangles.size());
    const Triangle& made = copy.triangles[kept++];
    EXPECT_EQ(copy.positions[made.v[0]], means[a]);
    EXPECT_EQ(copy.positions[made.v[1]], means[b]);
    EXPECT_EQ(copy.positions[made.v[2]], means[c]);
  }
  EXPECT_EQ(kept, copy.triangles.size());
  EXPECT_GT(kept, cells.size());
}

// A ring round a ball with a ball in it, as it is and through its coarse copy: the faces see parts of both at a slant
// or not at all.
TEST(ChooseViews, SeesADenseModelAsItIs) {
  IndexedMesh mesh = torus_mesh(128, 72);
  Box3f box;
  for (const Vec3f p : mesh.positions) box.extend(p);
  const Vec3d middle = 0.5 * (to_double(box.lo) + to_double(box.hi));
  for (const double scale : {0.4, 0.2}) {
    const IndexedMesh ball = sphere_mesh(4, 0);
    const auto count = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3f p : ball.positions)
      mesh.positions.push_back(to_float(middle + scale * (to_double(p) - Vec3d{0.5, 0.5, 0.5})));
    for (Triangle t : ball.triangles) {
      for (std::uint32_t& v : t.v) v += count;
      mesh.triangles.push_back(t);
    }
  }
  const auto scheduler = make_serial_scheduler();
  const auto chosen = [&](int resolution) {
    return choose_views(mesh, {.candidates = 96, .samples = 3000, .resolution = resolution}, *scheduler);
  };
  ASSERT_GT(mesh.triangles.size(), 16u * 32 * 32);
  ASSERT_LT(mesh.triangles.size(), 16u * 128 * 128);
  const ChosenViews exact = chosen(128), coarse = chosen(32);
  EXPECT_LT(exact.visible, 0.98);
  EXPECT_NEAR(coarse.visible, exact.visible, 0.01);
  EXPECT_NEAR(coarse.coverable, exact.coverable, 0.01);
  EXPECT_NEAR(coarse.covered, exact.covered, 0.01);
}

}  // namespace
}  // namespace lodestone::test
