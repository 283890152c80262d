// A merged mesh finished: simplification with its attributes, parts that are too small, normals that face away.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/simplify/simplifiers.h"
#include "core/spatial/mesh_distance.h"
#include "core/spatial/point_triangle.h"
#include "experiments/metrics/geometry/mesh_quality.h"
#include "render/reconstruct/finish/lost_parts.h"
#include "render/reconstruct/finish/simplify_merged.h"
#include "render/reconstruct/finish/surface_walk.h"
#include "render/reconstruct/finish/turn_normals.h"
#include "tests/test_meshes.h"

namespace lodestone::test {
namespace {

MergedMesh merged_of(const IndexedMesh& mesh) {
  MergedMesh merged;
  const std::size_t n = mesh.positions.size();
  merged.position = mesh.positions, merged.triangles = mesh.triangles;
  merged.normal.resize(n), merged.view.resize(n), merged.pixel.resize(n), merged.feature.resize(n);
  for (std::uint32_t v = 0; v < n; ++v) merged.pixel[v] = v;
  return merged;
}

RawMesh surface_of(const MergedMesh& m) {
  RawMesh raw;
  for (const Vec3f& p : m.position) raw.positions.push_back(to_double(p));
  raw.triangles = m.triangles;
  return raw;
}

MeshQuality quality_of(const MergedMesh& m) { return measure_quality(surface_of(m).positions, m.triangles); }

TEST(SimplifyMerged, OfOneCubeIsWhatTheSimplifierMakes) {
  const IndexedMesh mesh = sphere_mesh(5);
  const auto serial = make_serial_scheduler();
  MergedMesh merged = merged_of(mesh);
  RawWedges none;
  simplify_merged(merged, none, {.triangles = 3000}, *serial);

  const std::vector<std::uint8_t> free(mesh.positions.size(), 0);
  SimplifyInput input{mesh.positions, mesh.triangles, free, 1, 3000};
  const auto simplifier = make_simplifier("quadric");
  const SimplifyResult& result = simplifier->simplify(input);
  std::vector<std::array<Vec3f, 3>> expected, found;
  for (const Triangle& t : mesh.triangles) {
    const Triangle image{{result.parent[t.v[0]], result.parent[t.v[1]], result.parent[t.v[2]]}};
    if (!is_degenerate(image))
      expected.push_back({result.positions[image.v[0]], result.positions[image.v[1]], result.positions[image.v[2]]});
  }
  for (const Triangle& t : merged.triangles)
    found.push_back({merged.position[t.v[0]], merged.position[t.v[1]], merged.position[t.v[2]]});
  EXPECT_EQ(found, expected);
  for (std::size_t v = 0; v < merged.position.size(); ++v) EXPECT_LT(merged.pixel[v], mesh.positions.size());
}

TEST(SimplifyMerged, OfManyCubesIsAsGoodAsOfOne) {
  const IndexedMesh mesh = sphere_mesh(6, 0.2);
  const auto serial = make_serial_scheduler(), three = make_tbb_scheduler(3);
  const RawMesh original = raw_of(mesh);
  RawWedges none;
  const auto made = [&](std::size_t in_cube, Scheduler& scheduler) {
    MergedMesh merged = merged_of(mesh);
    simplify_merged(merged, none, {.triangles = 8000, .farthest = 0.1f, .cube_triangles = in_cube}, scheduler);
    return merged;
  };
  const MergedMesh one = made(1'000'000, *serial), many = made(2000, *serial), again = made(2000, *three);
  EXPECT_EQ(many.position, again.position);
  EXPECT_EQ(many.triangles, again.triangles);
  for (const MergedMesh& m : {one, many}) {
    EXPECT_NEAR(static_cast<double>(m.triangles.size()), 8000, 80);
    const MeshQuality quality = quality_of(m);
    EXPECT_TRUE(quality.closed() && quality.manifold());
    EXPECT_EQ(quality.euler, 2);
  }
  const auto rms = [&](const MergedMesh& m) { return compare_meshes(original, surface_of(m)).forward.rms; };
  EXPECT_LT(rms(many), 1.15 * rms(one));
}

TEST(SimplifyMerged, TakesHardInput) {
  const auto serial = make_serial_scheduler();
  RawWedges none;
  MergedMesh nothing;
  simplify_merged(nothing, none, {.triangles = 0}, *serial);
  EXPECT_TRUE(nothing.triangles.empty());
  MergedMesh one = merged_of(sphere_mesh(0));
  one.triangles.resize(1);
  simplify_merged(one, none, {.triangles = 0}, *serial);
  EXPECT_LE(one.triangles.size(), 1u);
  MergedMesh enough = merged_of(sphere_mesh(2));
  const std::vector<Triangle> before = enough.triangles;
  simplify_merged(enough, none, {.triangles = before.size()}, *serial);
  EXPECT_EQ(enough.triangles, before);
}

// The point of the terrain above a place.
Vec3d above(const IndexedMesh& terrain, Vec2f at) {
  for (const Triangle& t : terrain.triangles) {
    const Vec3d a = to_double(terrain.positions[t.v[0]]), b = to_double(terrain.positions[t.v[1]]) - a,
                c = to_double(terrain.positions[t.v[2]]) - a;
    const double area = b.x * c.y - b.y * c.x, x = at.x - a.x, y = at.y - a.y;
    const double u = (x * c.y - y * c.x) / area, v = (b.x * y - b.y * x) / area;
    if (u >= -1e-4 && v >= -1e-4 && u + v <= 1 + 1e-4) return a + u * b + v * c;
  }
  return {9, 9, 9};
}

// The distance of a point from the nearest triangle, by trying all.
double distance_from(const IndexedMesh& mesh, Vec3d p) {
  double least = 1e9;
  for (const Triangle& t : mesh.triangles)
    least = std::min(least, nearest_on_triangle(p, to_double(mesh.positions[t.v[0]]), to_double(mesh.positions[t.v[1]]),
                                                to_double(mesh.positions[t.v[2]]))
                                .squared_distance);
  return std::sqrt(least);
}

// Every vertex has what the terrain has at a place that is, but for what the second pass adds (a third of a cell of the
// terrain), the nearest one.
TEST(SimplifyMerged, MovesAttributesWithTheSurface) {
  const IndexedMesh mesh = terrain_mesh(40, 0.1);
  const auto serial = make_serial_scheduler();
  for (const bool seam : {false, true}) {
    MergedMesh merged = merged_of(mesh);
    RawWedges wedges;
    for (const Vec3f& p : mesh.positions) wedges.uv.push_back({p.x, p.y});
    if (seam) {  // what is beyond the middle is one chart aside
      wedges.corners = mesh.triangles;
      std::vector<std::uint32_t> twin(mesh.positions.size(), no_triangle);
      for (Triangle& t : wedges.corners) {
        const auto& p = mesh.positions;
        if ((p[t.v[0]].x + p[t.v[1]].x + p[t.v[2]].x) / 3 < 0.5f) continue;
        for (std::uint32_t& w : t.v) {
          if (twin[w] == no_triangle) {
            twin[w] = static_cast<std::uint32_t>(wedges.uv.size());
            wedges.uv.push_back({wedges.uv[w].x + 2, wedges.uv[w].y});
          }
          w = twin[w];
        }
      }
    }
    simplify_merged(merged, wedges, {.triangles = 800, .cube_triangles = 1000}, *serial);
    EXPECT_EQ(wedges.corners.empty(), !seam);
    EXPECT_LT(merged.triangles.size(), 900u);
    const std::vector<Triangle>& corners = seam ? wedges.corners : merged.triangles;
    for (std::size_t t = 0; t < corners.size(); ++t) {
      const bool aside = wedges.uv[corners[t].v[0]].x >= 1.5f;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d p = to_double(merged.position[merged.triangles[t].v[k]]);
        const Vec2f uv = wedges.uv[corners[t].v[k]];
        EXPECT_LT(length(above(mesh, {uv.x - (aside ? 2 : 0), uv.y}) - p), distance_from(mesh, p) + 4e-3);
      }
    }
  }
}

TEST(SurfaceWalk, FindsWhatIsNearest) {
  const IndexedMesh mesh = sphere_mesh(4, 0);  // convex: nothing else is nearest to a point outside than around it
  const SurfaceWalk walk(mesh.positions, mesh.triangles);
  const auto point_on = [&](std::uint32_t t) {
    Vec3d sum;
    for (const std::uint32_t v : mesh.triangles[t].v) sum = sum + (1.0 / 3) * to_double(mesh.positions[v]);
    return sum;
  };
  for (std::uint32_t t = 0; t < mesh.triangles.size(); t += 37) {
    const Vec3d p = point_on(t) + 0.01 * (point_on(t) - Vec3d{0.5, 0.5, 0.5});
    std::uint32_t start = t;  // some triangles away
    for (std::uint32_t other = 0; other < mesh.triangles.size(); ++other)
      if (length(point_on(other) - point_on(t)) < 0.1) start = other;
    const SurfaceWalk::Place place = walk.find(TriangleId(start), p);
    Vec3d q;
    for (std::size_t k = 0; k < 3; ++k)
      q = q + place.share[k] * to_double(mesh.positions[mesh.triangles[place.triangle].v[k]]);
    EXPECT_NEAR(length(q - p), distance_from(mesh, p), 1e-9);
  }
}

TEST(LostParts, AreTakenOver) {
  // A ball and a scrap beside it, smaller than a pixel, closed and open, and one too small for anything.
  IndexedMesh mesh = sphere_mesh(4);
  const auto add_tetrahedron = [&](Vec3f at, float size, bool closed) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3f& d : {Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, 0, 1}})
      mesh.positions.push_back(at + size * d);
    const std::uint32_t v[4][3]{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    for (int k = closed ? 0 : 3; k < 4; ++k)
      mesh.triangles.push_back({{first + v[k][0], first + v[k][1], first + v[k][2]}});
  };
  add_tetrahedron({0.02f, 0.02f, 0.02f}, 0.02f, true);
  add_tetrahedron({0.97f, 0.97f, 0.97f}, 0.02f, false);
  add_tetrahedron({0.97f, 0.02f, 0.97f}, 0.001f, true);
  const auto serial = make_serial_scheduler();
  for (const bool closed : {false, true}) {
    MergedMesh merged = merged_of(sphere_mesh(4));
    std::vector<std::uint32_t> source(merged.position.size(), 0);
    const std::size_t before = merged.triangles.size();
    const LostParts lost = take_over_lost_parts(mesh, 0.02, merged, source, closed, *serial);
    EXPECT_EQ(lost.triangles, closed ? 4u : 5u);
    EXPECT_EQ(merged.triangles.size(), before + lost.triangles);
    EXPECT_EQ(source.size(), merged.position.size());
    EXPECT_TRUE(quality_of(merged).manifold());
    EXPECT_EQ(quality_of(merged).closed(), closed);
    for (std::size_t v = source.size() - (closed ? 4 : 7); v < source.size(); ++v) {
      const Vec3f a = mesh.positions[mesh.triangles[source[v]].v[0]];
      EXPECT_LT(length(a - merged.position[v]), 0.04f);
    }
  }
}

// A strip of two triangles that is folded back on itself, with the normals of the sheet below.
RawMesh folded_sheet() {
  RawMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.1, 0.1}};
  mesh.triangles = {{{0, 1, 2}}, {{2, 1, 3}}};
  mesh.wedges.normal.assign(4, {0, 0, 1});
  mesh.wedges.uv = {{0, 0}, {1, 0}, {0, 1}, {0.5f, 0.5f}};
  return mesh;
}

std::size_t backward_corners(const RawMesh& mesh) {
  const auto& corners = mesh.wedges.corners.empty() ? mesh.triangles : mesh.wedges.corners;
  std::size_t backward = 0;
  for (std::size_t t = 0; t < corners.size(); ++t) {
    const auto at = [&](std::size_t k) { return mesh.positions[mesh.triangles[t].v[k]]; };
    for (const std::uint32_t w : corners[t].v)
      backward += dot(to_double(mesh.wedges.normal[w]), cross(at(1) - at(0), at(2) - at(0))) < 0;
  }
  return backward;
}

TEST(TurnNormals, LeavesNoneThatFacesAway) {
  RawMesh mesh = folded_sheet();
  ASSERT_EQ(backward_corners(mesh), 3u);
  EXPECT_EQ(turn_normals(mesh), 3u);
  EXPECT_EQ(backward_corners(mesh), 0u);
  EXPECT_EQ(mesh.triangles, folded_sheet().triangles);
  EXPECT_EQ(mesh.wedges.normal[0], (Vec3f{0, 0, 1}));  // faced its triangle, and others' wedges are not its own
  ASSERT_EQ(mesh.wedges.uv.size(), mesh.wedges.normal.size());
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(mesh.wedges.uv[mesh.wedges.corners[t].v[k]], folded_sheet().wedges.uv[mesh.triangles[t].v[k]]);
}

TEST(TurnNormals, LeavesTrianglesThatAreInsideOutAlone) {
  RawMesh mesh = folded_sheet();
  for (Triangle& t : mesh.triangles) std::swap(t.v[1], t.v[2]);
  mesh.triangles.resize(1);
  const RawMesh before = mesh;
  EXPECT_EQ(turn_normals(mesh), 0u);
  EXPECT_EQ(mesh.wedges, before.wedges);
  mesh.wedges = {};
  EXPECT_EQ(turn_normals(mesh), 0u);
}

}  // namespace
}  // namespace lodestone::test
