// How near a reconstruction is to its model: to a sphere, at edges and creases, in its attributes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "experiments/metrics/geometry/mesh_quality.h"
#include "render/reconstruct/views/choose_views.h"
#include "tests/render/reconstruct/small_reconstruction.h"

namespace lodestone::test {
namespace {

// Mean error (root of squares) of a mesh of samples on the sphere, each direction seen by the best face: the error in a
// triangle of edges a, b, c is (1/2r) sum of lambda_i lambda_j d_ij^2, whose square's mean over the triangle is (a^4 +
// b^4 + c^4 + a^2 b^2 + b^2 c^2 + c^2 a^2) / (360 r^2).
double sampling_bound(double radius, double spacing) {
  double sum = 0;
  const std::vector<Vec3d> directions = sphere_directions(20'000);
  for (const Vec3d& n : directions) {
    double c[3]{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    std::sort(c, c + 3);
    const double gu = c[0] / c[2], gv = c[1] / c[2], h2 = spacing * spacing;
    const double a = h2 * (1 + gu * gu), b = h2 * (1 + gv * gv), d = h2 * (2 + (gu - gv) * (gu - gv));
    sum += (a * a + b * b + d * d + a * b + b * d + d * a) / (360 * radius * radius);
  }
  return std::sqrt(sum / static_cast<double>(directions.size()));
}

// Root of the mean square distance of points all over the mesh from the sphere.
double rms_from_sphere(const RawMesh& mesh, Vec3d centre, double radius) {
  double sum = 0, area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.positions[t.v[0]] - centre, b = mesh.positions[t.v[1]] - centre,
                c = mesh.positions[t.v[2]] - centre;
    const double size = length(cross(b - a, c - a));
    constexpr int n = 6;
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        const double u = (i + 1.0 / 3) / n, v = (j + 1.0 / 3) / n;
        const double off = length(a + u * (b - a) + v * (c - a)) - radius;
        sum += size * off * off / (n * (n + 1) / 2);
      }
    area += size;
  }
  return std::sqrt(sum / area);
}

TEST(Reconstruct, IsAsNearToASphereAsItsSamplesAllow) {
  const auto scheduler = make_tbb_scheduler(2);
  const IndexedMesh mesh = sphere_mesh(8, 0);  // finer than the pixels by far
  for (const double resolution : {32.0, 64.0}) {
    ReconstructConfig config = small_config(resolution);
    config.views.least = config.views.most = 6;
    config.condense = false;
    config.detail = 1;
    const double bound = sampling_bound(1, 2 / resolution);
    EXPECT_LT(rms_from_sphere(reconstruct(mesh, config, *scheduler).mesh, {0, 0, 0}, 1), 1.1 * bound);
    config.condense = true;
    EXPECT_LT(rms_from_sphere(reconstruct(mesh, config, *scheduler).mesh, {0, 0, 0}, 1), 0.6 * bound);
    config.detail = 2;
    EXPECT_LT(rms_from_sphere(reconstruct(mesh, config, *scheduler).mesh, {0, 0, 0}, 1), 0.6 * bound);
  }
}

TEST(Reconstruct, RecoversTheEdgesOfABox) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  add_box({0, 0, 0}, {3, 2, 1}, 3, positions, triangles);
  const IndexedMesh mesh = clean(positions, triangles);
  const auto serial = make_serial_scheduler();
  ReconstructConfig config = small_config(37);
  const Reconstruction sharp = reconstruct(mesh, config, *serial);
  config.sharp_degrees = 0;
  const Reconstruction blunt = reconstruct(mesh, config, *serial);
  const MeshQuality quality = measure_quality(sharp.mesh.positions, sharp.mesh.triangles);
  EXPECT_TRUE(quality.closed() && quality.manifold());
  EXPECT_GT(sharp.report.sharpen.edges, 100u);
  const auto farthest = [&](const RawMesh& m) { return compare_meshes(original(mesh), m).forward.max; };
  EXPECT_LT(farthest(sharp.mesh), 0.1 * farthest(blunt.mesh));
  EXPECT_LT(diagonal_share(sharp.mesh, mesh), 1e-4);
}

// A drum in no particular direction, whose rims are circles around the axis.
struct Drum {
  static constexpr double radius = 1, half = 0.4;
  Vec3d axis = (1 / std::sqrt(1.89)) * Vec3d{0.5, -0.8, 1};
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;

  Drum() {
    constexpr std::uint32_t sides = 120;
    const Vec3d aside = cross(axis, {1, 0, 0}), x = (1 / length(aside)) * aside, y = cross(axis, x);
    for (std::uint32_t k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      const Vec3d p = radius * (std::cos(angle) * x + std::sin(angle) * y);
      positions.push_back(p - half * axis), positions.push_back(p + half * axis);
      const std::uint32_t a = 2 * k, b = 2 * ((k + 1) % sides), bottom = 2 * sides, top = bottom + 1;
      for (const Triangle t : {Triangle{{a, b, b + 1}}, {{a, b + 1, a + 1}}, {{b, a, bottom}}, {{a + 1, b + 1, top}}})
        triangles.push_back(t);
    }
    positions.push_back(-half * axis), positions.push_back(half * axis);
  }
  [[nodiscard]] double from_rim(Vec3d p) const {
    const double along = dot(p, axis);
    return std::hypot(length(p - along * axis) - radius, std::abs(along) - half);
  }
};

// Distances from the rims, at the ends of edges that bend by over 25 degrees; slivers, which do not show, left out.
std::vector<double> crease_distances(const RawMesh& mesh, const Drum& drum, double least_height) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3d> normal_at;
  for (const Triangle& t : mesh.triangles) {
    const auto& p = mesh.positions;
    const Vec3d n = cross(p[t.v[1]] - p[t.v[0]], p[t.v[2]] - p[t.v[0]]);
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, length(p[t.v[k]] - p[t.v[(k + 1) % 3]]));
    if (length(n) < least_height * longest) continue;
    for (std::size_t k = 0; k < 3; ++k) normal_at[{t.v[k], t.v[(k + 1) % 3]}] = (1 / length(n)) * n;
  }
  std::vector<double> distances;
  for (const auto& [edge, n] : normal_at) {
    const auto other = normal_at.find({edge.second, edge.first});
    if (other != normal_at.end() && dot(n, other->second) < std::cos(25 * std::numbers::pi / 180))
      distances.push_back(drum.from_rim(mesh.positions[edge.first]));
  }
  return distances;
}

TEST(Reconstruct, CreasesHaveNoTeeth) {
  const Drum drum;
  const IndexedMesh mesh = clean(drum.positions, drum.triangles);
  const auto serial = make_serial_scheduler();
  const Reconstruction made = reconstruct(mesh, small_config(64), *serial);
  const double pixel = made.report.spacing * mesh.transform.scale;
  const std::vector<double> distances = crease_distances(made.mesh, drum, 0.15 * pixel);
  EXPECT_GT(static_cast<double>(distances.size()) * pixel, 4 * std::numbers::pi);
  double sum = 0;
  std::size_t far = 0;
  for (const double d : distances) sum += d * d, far += d > 0.25 * pixel;
  const auto count = static_cast<double>(distances.size());
  EXPECT_LT(std::sqrt(sum / count), 0.03 * pixel);
  EXPECT_LT(static_cast<double>(far), 0.01 * count);
}

TEST(Reconstruct, ResamplesTextureCoordinatesAndColours) {
  IndexedMesh mesh = terrain_mesh(30, 0.1);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3f p = mesh.positions[v];
    mesh.wedges.vertex.push_back(v);
    mesh.wedges.uv.push_back({p.x, p.y});
    mesh.wedges.colour.push_back({static_cast<std::uint8_t>(255 * p.x + 0.5f), 0, 0, 255});
  }
  const auto serial = make_serial_scheduler();
  ReconstructConfig config = small_config(40);
  config.attributes = true;
  const RawMesh result = reconstruct(mesh, config, *serial).mesh;
  const RawWedges& w = result.wedges;
  ASSERT_FALSE(w.uv.empty());
  for (std::size_t t = 0; t < result.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p = result.positions[result.triangles[t].v[k]];
      const std::uint32_t wedge = w.corners.empty() ? result.triangles[t].v[k] : w.corners[t].v[k];
      EXPECT_NEAR(w.uv[wedge].x, p.x, 4e-3);  // a tenth of a pixel: a vertex is off its triangle
      EXPECT_NEAR(w.uv[wedge].y, p.y, 4e-3);
      EXPECT_NEAR(w.colour[wedge].r, 255 * p.x, 2);
    }
}

}  // namespace
}  // namespace lodestone::test
