// Improvements of a reconstruction: simplification of finer samples, views past obstacles, parts that are too small,
// attributes from the right side of a seam.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "core/simplify/simplifiers.h"
#include "core/spatial/mesh_distance.h"
#include "core/spatial/point_triangle.h"
#include "experiments/metrics/geometry/mesh_quality.h"
#include "experiments/metrics/geometry/surface_coverage.h"
#include "render/reconstruct/finish/lost_parts.h"
#include "render/reconstruct/finish/simplify_merged.h"
#include "render/reconstruct/finish/surface_walk.h"
#include "render/reconstruct/finish/turn_normals.h"
#include "render/reconstruct/reconstruct.h"
#include "render/reconstruct/views/inside_views.h"
#include "tests/render/reconstruct/obvious_map.h"

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

RawMesh raw_of(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles) {
  RawMesh raw;
  for (const Vec3f& p : positions) raw.positions.push_back(to_double(p));
  raw.triangles = triangles;
  return raw;
}

MeshQuality quality_of(const MergedMesh& m) {
  const RawMesh raw = raw_of(m.position, m.triangles);
  return measure_quality(raw.positions, raw.triangles);
}

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
  const RawMesh original = raw_of(mesh.positions, mesh.triangles);
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
  const auto rms = [&](const MergedMesh& m) {
    return compare_meshes(original, raw_of(m.position, m.triangles)).forward.rms;
  };
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

// The point of the terrain above a place, and the distance of a point from it.
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
    double least = 1e9;
    for (const Triangle& u : mesh.triangles)
      least = std::min(least, nearest_on_triangle(p, to_double(mesh.positions[u.v[0]]),
                                                  to_double(mesh.positions[u.v[1]]), to_double(mesh.positions[u.v[2]]))
                                  .squared_distance);
    Vec3d q;
    for (std::size_t k = 0; k < 3; ++k)
      q = q + place.share[k] * to_double(mesh.positions[mesh.triangles[place.triangle].v[k]]);
    EXPECT_NEAR(length(q - p), std::sqrt(least), 1e-9);
  }
}

// A terrain of two charts that meet along an oblique line.
TEST(ResampleAttributes, SeamsRunWhereThoseOfTheSourceDo) {
  IndexedMesh mesh = terrain_mesh(60, 0.05);
  for (Vec3f& p : mesh.positions) p.x = 0.8f * p.x + 0.2f * p.y;  // columns become oblique
  const auto count = static_cast<std::uint32_t>(mesh.positions.size());
  constexpr std::uint32_t n = 60, seam = 31;
  for (std::uint32_t v = 0; v < count; ++v) {
    mesh.wedges.vertex.push_back(v);
    mesh.wedges.uv.push_back({0.4f * mesh.positions[v].x, mesh.positions[v].y});
  }
  for (Triangle& t : mesh.triangles) {  // those right of the column have wedges of their own
    if ((t.v[0] % (n + 1) + t.v[1] % (n + 1) + t.v[2] % (n + 1)) <= 3 * seam) continue;
    for (std::uint32_t& v : t.v) v += count;
  }
  for (std::uint32_t v = 0; v < count; ++v) {
    mesh.wedges.vertex.push_back(v);
    mesh.wedges.uv.push_back({0.5f + 0.4f * mesh.positions[v].x, mesh.positions[v].y});
    mesh.positions.push_back(Vec3f{mesh.positions[v]});
  }
  const auto serial = make_serial_scheduler();
  ReconstructConfig config;
  config.resolution = 48;
  config.attributes = true;
  config.views.samples = 3000;
  config.views.candidates = 40;
  const RawMesh result = reconstruct(mesh, config, *serial).mesh;
  ASSERT_FALSE(result.wedges.corners.empty());
  std::vector<std::set<std::uint32_t>> wedges(result.positions.size());
  for (std::size_t t = 0; t < result.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) wedges[result.triangles[t].v[k]].insert(result.wedges.corners[t].v[k]);
  double sum = 0, on_seam = 0;
  for (std::size_t v = 0; v < wedges.size(); ++v) {
    if (wedges[v].size() < 2) continue;
    const double along = result.positions[v].y, off = result.positions[v].x - (0.8 * seam / n + 0.2 * along);
    sum += off * off, ++on_seam;
  }
  ASSERT_GT(on_seam, 20);
  EXPECT_LT(std::sqrt(sum / on_seam), 0.05 / config.resolution);
}

// A cylinder whose texture goes round it once: one chart that touches itself along a seam.
TEST(ResampleAttributes, NeverRunsBackwardsThroughAnAtlas) {
  IndexedMesh mesh;
  constexpr std::uint32_t n = 64, rows = 16;
  for (std::uint32_t j = 0; j <= rows; ++j)
    for (std::uint32_t k = 0; k <= n; ++k) {  // the last column coincides with the first
      const double angle = 2 * 3.14159265358979 * (k % n) / n;
      mesh.positions.push_back({static_cast<float>(0.5 + 0.4 * std::cos(angle)),
                                static_cast<float>(0.5 + 0.4 * std::sin(angle)), static_cast<float>(j) / rows});
      mesh.wedges.uv.push_back({static_cast<float>(k) / n, static_cast<float>(j) / rows});
      mesh.wedges.vertex.push_back(j * (n + 1) + k % n);
    }
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t a = j * (n + 1) + k, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({{a, b, d}}), mesh.triangles.push_back({{a, d, c}});
    }
  const auto serial = make_serial_scheduler();
  for (const double detail : {1.0, 2.0}) {
    ReconstructConfig config;
    config.resolution = 37;
    config.detail = detail;
    config.attributes = true;
    config.views.samples = 3000;
    config.views.candidates = 40;
    const RawMesh result = reconstruct(mesh, config, *serial).mesh;
    ASSERT_FALSE(result.wedges.corners.empty());
    for (std::size_t t = 0; t < result.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2f uv = result.wedges.uv[result.wedges.corners[t].v[k]],
                    next = result.wedges.uv[result.wedges.corners[t].v[(k + 1) % 3]];
        EXPECT_LT(std::abs(uv.x - next.x), 0.45f) << t;
        EXPECT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
        const Vec3d p = result.positions[result.triangles[t].v[k]];
        double turn = std::atan2(p.y - 0.5, p.x - 0.5) / (2 * 3.14159265358979);
        turn -= std::floor(turn);
        const double off = std::abs(uv.x - turn);  // clamped at the seam by up to a pixel
        EXPECT_LT(std::min(off, 1 - off), 0.02);
      }
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

// A ball in a ball that has a hole of a few pixels: no view from outside sees much of the inner one.
TEST(InsideViews, LookPastWhatIsInTheWay) {
  const IndexedMesh ball = sphere_mesh(5, 0);
  IndexedMesh mesh = ball;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3f& p : ball.positions)
    mesh.positions.push_back({0.5f + 0.5f * (p.x - 0.5f), 0.5f + 0.5f * (p.y - 0.5f), 0.5f + 0.5f * (p.z - 0.5f)});
  for (const Triangle& t : ball.triangles) mesh.triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
  const auto serial = make_serial_scheduler(), two = make_tbb_scheduler(2);
  ReconstructConfig config;
  config.resolution = 40;
  config.views.candidates = 24, config.views.samples = 3000, config.views.resolution = 64;
  const Reconstruction result = reconstruct(mesh, config, *serial);
  EXPECT_GE(result.report.views.inside.size(), 4u);
  EXPECT_LE(result.report.views.inside.size(), 12u);
  EXPECT_EQ(measure_quality(result.mesh.positions, result.mesh.triangles).components, 2u);
  std::vector<Vec3d> inner;
  for (std::size_t v = first; v < mesh.positions.size(); ++v) inner.push_back(to_double(mesh.positions[v]));
  EXPECT_GT(measure_coverage(inner, result.mesh, mesh.transform, result.report.spacing, *serial).share, 0.995);
  EXPECT_EQ(reconstruct(mesh, config, *two).mesh.positions, result.mesh.positions);
  config.views.inside = 0;
  config.lost_parts = false;
  const Reconstruction outside = reconstruct(mesh, config, *serial);
  EXPECT_EQ(measure_coverage(inner, outside.mesh, mesh.transform, outside.report.spacing, *serial).share, 0);
}

TEST(InsideViews, AreNotWantedWhereAllIsSeen) {
  const IndexedMesh mesh = sphere_mesh(5, 0.1);
  const auto serial = make_serial_scheduler();
  ReconstructConfig config;
  config.resolution = 60;
  config.views.candidates = 24, config.views.samples = 3000, config.views.resolution = 64;
  EXPECT_TRUE(reconstruct(mesh, config, *serial).report.views.inside.empty());
}

TEST(SurfaceCoverage, CountsWhatIsNear) {
  const IndexedMesh mesh = sphere_mesh(4, 0);
  const RawMesh raw = raw_of(mesh.positions, mesh.triangles);
  const auto serial = make_serial_scheduler();
  const std::vector<Vec3d> points{{0.5, 0.5, 1.0}, {0.5, 0.5, 1.1}, {0.5, 0.5, 1.2}, {1.3, 0.5, 0.5}};
  const SurfaceCoverage c = measure_coverage(points, raw, Transform{}, 0.15, *serial);
  EXPECT_EQ(c.share, 0.5);
  EXPECT_NEAR(c.max, 0.3, 2e-3);
  EXPECT_NEAR(c.rms, std::sqrt((0.01 + 0.04 + 0.09) / 4), 2e-3);
  EXPECT_EQ(measure_coverage({}, raw, Transform{}, 0.1, *serial).share, 1);
  const SurfaceCoverage nothing = measure_coverage(points, RawMesh{}, Transform{}, 0.1, *serial);
  EXPECT_EQ(nothing.share, 0);
  EXPECT_TRUE(std::isinf(nothing.rms));
}

// From all around, a convex body shows each face in proportion to its area (Cauchy), and nothing that lies inside.
TEST(SurfaceCoverage, PicturesShowFacesByAreaAndNothingInside) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  add_box({0, 0, 0}, {0.9, 0.6, 0.3}, 1, positions, triangles);
  add_box({0.2, 0.2, 0.1}, {0.4, 0.4, 0.2}, 1, positions, triangles);
  IndexedMesh mesh;
  for (const Vec3d& p : positions) mesh.positions.push_back(to_float(p));
  mesh.triangles = triangles;
  const auto serial = make_serial_scheduler();
  const std::vector<Vec3d> points = points_in_pictures(mesh, {}, *serial);
  EXPECT_EQ(points, points_in_pictures(mesh, {}, *make_tbb_scheduler(3)));
  EXPECT_GT(points.size(), 10'000u);
  const double extent[] = {0.9, 0.6, 0.3}, area[] = {0.18, 0.27, 0.54};
  std::size_t faces[3]{};
  for (const Vec3d& p : points) {
    const double at[] = {p.x, p.y, p.z};
    int on = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const bool here = std::min(std::abs(at[k]), std::abs(at[k] - extent[k])) < 1e-6;
      faces[k] += here, on += here;
    }
    EXPECT_GE(on, 1);
  }
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(static_cast<double>(faces[k]) / static_cast<double>(points.size()), area[k] / 0.99, 0.01);
  EXPECT_TRUE(points_in_pictures({}, {}, *serial).empty());
}

}  // namespace
}  // namespace lodestone::test
