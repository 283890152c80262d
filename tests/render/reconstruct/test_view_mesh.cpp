// View meshes: what is connected and what is not.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "render/reconstruct/finish/label_parts.h"
#include "render/reconstruct/views/view_mesh.h"
#include "tests/render/reconstruct/obvious_map.h"

namespace lodestone::test {
namespace {

const MapView from_above{Projection::orthographic, {0.5, 0.5, 2}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 1.0 / 32, 40, 40};

PositionMap draw(const IndexedMesh& mesh, const MapView& view = from_above) {
  const auto serial = make_serial_scheduler();
  return rasterize_map(mesh, view, {}, *serial);
}

std::vector<Triangle> triangles_of(const PositionMap& map, const ConnectConfig& config = {}) {
  std::vector<Triangle> triangles;
  list_triangles(connect(map, config), map.view.width, 0, map.view.height, triangles);
  return triangles;
}

IndexedMesh from_boxes(const std::vector<std::pair<Vec3d, Vec3d>>& boxes, std::uint32_t n = 2) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  for (const auto& [lo, hi] : boxes) add_box(lo, hi, n, positions, triangles);
  IndexedMesh mesh;
  for (const Vec3d& p : positions) mesh.positions.push_back(to_float(p));
  mesh.triangles = triangles;
  return mesh;
}

TEST(ViewMesh, OfAPlaneIsThatPlane) {
  IndexedMesh mesh = terrain_mesh(5, 0);
  for (Vec3f& p : mesh.positions) p.z = 0.25f + 0.5f * p.x + 0.1f * p.y;
  mesh.transform = {};
  const PositionMap map = draw(mesh);
  const std::vector<Triangle> triangles = triangles_of(map);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < map.triangle.size(); ++i) seen += map.sees(i);
  EXPECT_EQ(seen, 32u * 32u);
  EXPECT_EQ(triangles.size(), 2u * 31 * 31);
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t.v) {
      const Vec3f p = map.position[v];
      EXPECT_NEAR(p.z, 0.25 + 0.5 * p.x + 0.1 * p.y, 1e-6);
    }
}

TEST(ViewMesh, OfNothingIsEmpty) {
  PositionMap map = empty_map(terrain_mesh(2), from_above, {}, PixelGroups::all(from_above.pixels()));
  EXPECT_TRUE(triangles_of(map).empty());
  EXPECT_TRUE(extend_to_silhouette(map, 8).empty());
}

TEST(ViewMesh, FacesTheViewerOrTurnsItsBack) {
  const IndexedMesh mesh = terrain_mesh(6, 0.1);
  MapView from_below = from_above;
  from_below.eye.z = -1, from_below.forward = {0, 0, 1}, from_below.right = {-1, 0, 0};
  for (const MapView& view : {from_above, from_below}) {
    const PositionMap map = draw(mesh, view);
    const std::vector<Triangle> triangles = triangles_of(map);
    ASSERT_GT(triangles.size(), 1000u);
    for (const Triangle& t : triangles) {
      const Vec3f n = cross(map.position[t.v[1]] - map.position[t.v[0]], map.position[t.v[2]] - map.position[t.v[0]]);
      EXPECT_GT(n.z, 0);  // up, as the mesh says, from wherever it is seen
    }
  }
}

TEST(ViewMesh, BreaksWhereDepthJumps) {
  // A step of a quarter between two horizontal planes.
  const IndexedMesh mesh = from_boxes({{{0, 0, 0}, {0.5, 1, 0.5}}, {{0.5, 0, 0}, {1, 1, 0.25}}});
  const PositionMap map = draw(mesh);
  for (const Triangle& t : triangles_of(map)) {
    std::set<float> heights;
    for (const std::uint32_t v : t.v) heights.insert(map.position[v].z);
    EXPECT_EQ(heights.size(), 1u);
  }
  ConnectConfig lenient;
  lenient.slack = 20;  // spacings: more than the step
  EXPECT_GT(triangles_of(map, lenient).size(), triangles_of(map).size());
}

TEST(ViewMesh, DoesNotBreakOnASteepSlope) {
  IndexedMesh mesh = terrain_mesh(5, 0);
  for (Vec3f& p : mesh.positions) p.z = 4 * p.x;  // 76 degrees
  MapView view = from_above;
  view.eye.z = 6;
  EXPECT_EQ(triangles_of(draw(mesh, view)).size(), 2u * 31 * 31);
}

TEST(ViewMesh, TakesTheDiagonalThatBridgesLess) {
  PositionMap map =
      empty_map(terrain_mesh(2), {Projection::orthographic, {0, 0, 2}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 1, 2, 2}, {},
                PixelGroups::all(4));
  const float depth[2][4]{{1, 1, 1, 1.4f}, {1, 1.4f, 1, 1}};  // p q r s: the odd one is s, then q
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t i = 0; i < 4; ++i) {
      map.triangle[i] = 0, map.depth[i] = depth[k][i], map.normal[i] = {0, 0, 1};
      map.position[i] = {static_cast<float>(i % 2), -static_cast<float>(i / 2), 2 - depth[k][i]};
    }
    const std::uint8_t cell = connect(map, {}).cells[0];
    EXPECT_EQ(cell, k == 0 ? cell_prq | cell_rsq : cell_prs | cell_psq);
  }
}

TEST(ViewMesh, NeverConnectsPartsThatAbut) {
  // Two boxes side by side whose upper sides lie in one plane, but that share no vertex.
  const IndexedMesh mesh = from_boxes({{{0, 0, 0}, {0.5, 1, 0.5}}, {{0.5, 0, 0}, {1, 1, 0.5}}});
  const std::vector<std::uint32_t> parts = label_parts(mesh);
  ASSERT_EQ(parts.size(), mesh.triangles.size());
  const PositionMap map = draw(mesh);
  ConnectConfig config;
  const std::size_t joined = triangles_of(map, config).size();
  config.parts = parts;
  const std::vector<Triangle> triangles = triangles_of(map, config);
  EXPECT_EQ(joined - triangles.size(), 2u * 31);  // the column of cells between them
  for (const Triangle& t : triangles) EXPECT_EQ(parts[map.triangle[t.v[0]]], parts[map.triangle[t.v[1]]]);
}

TEST(ViewMesh, IsTheSameInPieces) {
  const PositionMap map = draw(sphere_mesh(4));
  const ViewMesh whole = connect(map, {});
  ViewMesh pieces;
  pieces.cells = map.triangle.like<std::uint8_t>();
  for (const auto& [first, last] : {std::pair{7, 23}, {0, 7}, {23, map.view.height}})
    connect_rows(map, {}, first, last, pieces);
  EXPECT_EQ(whole.cells, pieces.cells);
}

TEST(ViewMesh, CellsAgreeWithTheDefinition) {
  const PositionMap map = draw(torus_mesh(40, 20));
  const ViewMesh mesh = connect(map, {});
  const auto width = static_cast<std::size_t>(map.view.width);
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    if (!(mesh.cells[i] & cell_triangles)) continue;
    for_triangles_of_cell(mesh.cells[i], static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(width),
                          [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                            for (const auto& [s, t] : {std::pair{a, b}, {b, c}, {c, a}}) {
                              const int dx = static_cast<int>(t % width) - static_cast<int>(s % width),
                                        dy = static_cast<int>(t / width) - static_cast<int>(s / width);
                              EXPECT_TRUE(are_connected(map, {}, s, t, dx, dy));
                            }
                          });
  }
}

TEST(ViewMesh, ExtendsAWireOfOnePixelToAStrip) {
  const IndexedMesh mesh = from_boxes({{{0.5, 0, 0.2}, {0.53, 1, 0.23}}});
  PositionMap map = draw(mesh);
  EXPECT_TRUE(triangles_of(map).empty());
  EXPECT_FALSE(extend_to_silhouette(map, 8).empty());
  const std::vector<Triangle> triangles = triangles_of(map);
  EXPECT_GT(triangles.size(), 60u);
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t.v) EXPECT_NEAR(map.position[v].x, 0.515, 0.035);
}

TEST(ViewMesh, EstimatesTheNormalsOfAPlane) {
  IndexedMesh mesh = terrain_mesh(5, 0);
  for (Vec3f& p : mesh.positions) p.z = 0.5f * p.x;
  PositionMap map = draw(mesh);
  map.normal.clear();
  estimate_normals(map);
  for (std::size_t i = 0; i < map.triangle.size(); ++i)
    EXPECT_TRUE(!map.sees(i) || length(map.normal[i] - (1 / std::sqrt(1.25f)) * Vec3f{-0.5f, 0, 1}) < 1e-4f);
}

}  // namespace
}  // namespace lodestone::test
