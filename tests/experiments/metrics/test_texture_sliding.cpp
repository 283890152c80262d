// Sliding textures: known amounts, and the same by every triangle in turn.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/progressive/mesh/level.h"
#include "core/spatial/mesh_distance.h"
#include "core/spatial/surface_samples.h"
#include "experiments/metrics/geometry/texture_sliding.h"
#include "parallel/progressive/make_progressive.h"
#include "tests/expect_error.h"
#include "tests/parallel/progressive/progressive_meshes.h"

namespace lodestone::test {
namespace {

// A square with a vertex that comes in at its centre, whose texture is displaced by `slide` from the centre of the
// image.
ProgressiveMesh displaced_square(float slide) {
  ProgressiveMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5f, 0.5f, 0}};
  mesh.wedges.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5f + slide, 0.5f}};
  mesh.parents = {0, 0, 0, 0, 0};
  mesh.errors = {0.01f, 0.01f, 0.01f, 0.01f, 0.01f};
  mesh.triangles = {{{0, 1, 4}}, {{1, 2, 4}}, {{2, 3, 4}}, {{3, 0, 4}}};
  mesh.base_vertices = 4;
  return mesh;
}

TEST(TextureSliding, IsTheWayOfThePointWithTheSameCoordinates) {
  const SlidingConfig config{.points = 50'000, .texture_size = 10};
  EXPECT_NEAR(texture_sliding(displaced_square(0), 4, 5, config).max, 0, 1e-6);
  // The pyramid of ways has the height 0.1 and a third of it as its mean; a texel is a tenth wide and more where the
  // image is compressed, less where it is stretched: 1 / sqrt of 0.8 and of 1.2, which is drawn where it is wider than
  // a pixel of 0.01.
  const TextureSliding slid = texture_sliding(displaced_square(0.1f), 4, 5, config);
  EXPECT_EQ(slid.points, 50'000u);
  EXPECT_EQ(slid.left_out, 0);
  EXPECT_NEAR(slid.max, std::sqrt(1.2), 0.02);
  EXPECT_NEAR(slid.mean, (2 + std::sqrt(0.8) + std::sqrt(1.2)) / 4 / 3, 0.005);
  EXPECT_EQ(slid.image_mean, slid.mean);
  // Small texels are drawn as wide as a pixel, a hundredth of the square.
  const TextureSliding fine = texture_sliding(displaced_square(0.1f), 4, 5, {.points = 50'000, .texture_size = 1000});
  EXPECT_NEAR(fine.mean, 10.0 / 3, 0.05);
  EXPECT_NEAR(fine.image_mean, 100 * slid.mean, 1e-6);
}

// By every triangle, and with other formulas.
double slow_distance(const ProgressiveMesh& mesh, const std::vector<Triangle>& level, Vec3d from, double u, double v) {
  double best = 1e30;
  for (const Triangle& t : level) {
    const Vec2f a = mesh.wedges.uv[t.v[0]], b = mesh.wedges.uv[t.v[1]], c = mesh.wedges.uv[t.v[2]];
    const double bx = double{b.x} - a.x, by = double{b.y} - a.y, cx = double{c.x} - a.x, cy = double{c.y} - a.y;
    const double x = u - a.x, y = v - a.y, det = bx * cy - by * cx;
    if (det == 0) continue;
    const double s = (x * cy - y * cx) / det, r = (bx * y - by * x) / det;
    if (s < -1e-6 || r < -1e-6 || s + r > 1 + 1e-6) continue;
    const auto at = [&](std::size_t k) { return to_double(mesh.positions[t.v[k]]); };
    best = std::min(best, length(from - ((1 - s - r) * at(0) + s * at(1) + r * at(2))));
  }
  return best;
}

TEST(TextureSliding, EqualsItsSlowTwin) {
  const auto scheduler = make_serial_scheduler();
  ProgressiveReport report;
  const ProgressiveMesh mesh = make_progressive(textured_torus(24, 16, true, *scheduler),
                                                {.metric = progressive::MetricKind::parametric}, *scheduler, report);
  const LevelFinder levels(mesh);
  const std::uint32_t coarse = levels.vertices_for(mesh.vertex_count() / 3);
  const std::vector<Triangle> from = mesh.triangles, to = levels.compute_level(coarse);
  std::vector<Vec3d> positions, points;
  for (const Vec3f p : mesh.positions) positions.push_back(to_double(p));
  const SurfaceSamples samples(positions, from, 500);
  std::vector<std::uint32_t> at;
  samples.take(samples.vertices(), samples.size(), points, &at);
  double sum = 0, most = 0;
  std::uint64_t missed = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Triangle& t = from[at[k]];
    const Vec3d a = positions[t.v[0]], b = positions[t.v[1]] - a, c = positions[t.v[2]] - a, p = points[k] - a;
    const double bb = dot(b, b), bc = dot(b, c), cc = dot(c, c), det = bb * cc - bc * bc;
    const double s = (cc * dot(b, p) - bc * dot(c, p)) / det, r = (bb * dot(c, p) - bc * dot(b, p)) / det;
    const Vec2f x = mesh.wedges.uv[t.v[0]], y = mesh.wedges.uv[t.v[1]], z = mesh.wedges.uv[t.v[2]];
    const double u = (1 - s - r) * x.x + s * y.x + r * z.x, v = (1 - s - r) * x.y + s * y.y + r * z.y;
    const double distance = slow_distance(mesh, to, points[k], u, v);
    missed += distance > 1e29 ? 1 : 0;
    if (distance > 1e29) continue;
    const double area = std::abs((double{y.x} - x.x) * (double{z.y} - x.y) - (double{y.y} - x.y) * (double{z.x} - x.x));
    const double slid = distance / (std::sqrt(length(cross(b, c)) / area) / 1024);
    sum += slid, most = std::max(most, slid);
  }
  const TextureSliding fast = texture_sliding(mesh, coarse, mesh.vertex_count(), {.points = 500});
  EXPECT_NEAR(fast.image_mean, sum / static_cast<double>(points.size() - missed), 1e-6 * fast.image_mean);
  EXPECT_NEAR(fast.image_max, most, 1e-6 * most);
  EXPECT_NEAR(fast.left_out, static_cast<double>(missed) / static_cast<double>(points.size()), 1e-9);
  EXPECT_GT(fast.image_mean, 0);
}

TEST(TextureSliding, OfLevelsIsTheLargest) {
  const ProgressiveMesh mesh = displaced_square(0.1f);
  const SlidingOfLevels found = texture_sliding_of_levels(mesh, 3);
  EXPECT_EQ(found.whole.max, texture_sliding(mesh, 4, 5).max);
  EXPECT_EQ(found.step.max, found.whole.max);
}

TEST(TextureSliding, NeedsTextureCoordinates) {
  ProgressiveMesh mesh = displaced_square(0);
  mesh.wedges.uv.clear();
  expect_error_of<InputError>([&] { return texture_sliding(mesh, 4, 5); }, {"no texture coordinates"});
}

}  // namespace
}  // namespace lodestone::test
