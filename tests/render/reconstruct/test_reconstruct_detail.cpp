// Details of a reconstruction: attributes from the right side of a seam, views past obstacles.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "experiments/metrics/geometry/mesh_quality.h"
#include "experiments/metrics/geometry/surface_coverage.h"
#include "render/reconstruct/views/inside_views.h"
#include "tests/render/reconstruct/small_reconstruction.h"

namespace lodestone::test {
namespace {

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

}  // namespace
}  // namespace lodestone::test
