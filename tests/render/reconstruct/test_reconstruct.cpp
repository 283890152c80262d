// From a model to a new mesh: closed, manifold, near, and the same whatever does not matter.
#include <gtest/gtest.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/error.h"
#include "core/spatial/mesh_distance.h"
#include "experiments/metrics/geometry/mesh_quality.h"
#include "experiments/metrics/geometry/surface_coverage.h"
#include "render/reconstruct/from_maps.h"
#include "render/reconstruct/views/choose_views.h"
#include "tests/render/reconstruct/obvious_map.h"

namespace lodestone::test {
namespace {

ReconstructConfig small_config(double resolution) {
  ReconstructConfig config;
  config.resolution = resolution;
  config.views.candidates = 24;
  config.views.samples = 4000;
  config.views.resolution = 64;
  return config;
}

RawMesh original(const IndexedMesh& mesh) {
  RawMesh raw;
  for (const Vec3f& p : mesh.positions) raw.positions.push_back(mesh.transform.to_model(p));
  raw.triangles = mesh.triangles;
  return raw;
}

// Independent of our own counting: OpenMesh refuses faces that its half-edges cannot hold.
void expect_half_edges_hold(const RawMesh& mesh) {
  OpenMesh::TriMesh_ArrayKernelT<> half_edges;
  std::vector<OpenMesh::VertexHandle> handles;
  for (const Vec3d& p : mesh.positions)
    handles.push_back(
        half_edges.add_vertex({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}));
  for (const Triangle& t : mesh.triangles)
    ASSERT_TRUE(half_edges.add_face(handles[t.v[0]], handles[t.v[1]], handles[t.v[2]]).is_valid());
  for (const auto v : half_edges.vertices()) EXPECT_TRUE(half_edges.is_manifold(v));
}

void expect_sound(const RawMesh& mesh) {
  for (const Vec3d& p : mesh.positions) ASSERT_TRUE(is_finite(p));
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t.v) ASSERT_LT(v, mesh.positions.size());
    EXPECT_FALSE(is_degenerate(t));
  }
}

double diagonal_share(const RawMesh& result, const IndexedMesh& mesh) {
  const MeshDistance d = compare_meshes(original(mesh), result);
  return std::max(d.forward.rms, d.backward.rms) / d.diagonal;
}

TEST(Reconstruct, MakesClosedManifoldsOfClosedSurfaces) {
  const auto scheduler = make_tbb_scheduler(2);
  for (const IndexedMesh& mesh : {sphere_mesh(5), torus_mesh(80, 40)}) {
    const Reconstruction result = reconstruct(mesh, small_config(48), *scheduler);
    const MeshQuality quality = measure_quality(result.mesh.positions, result.mesh.triangles);
    EXPECT_TRUE(quality.closed() && quality.manifold());
    EXPECT_EQ(quality.components, 1u);
    EXPECT_EQ(quality.euler, measure_quality(original(mesh).positions, mesh.triangles).euler);
    EXPECT_LT(quality.sliver_share(), 0.005);
    expect_half_edges_hold(result.mesh);
    EXPECT_LT(diagonal_share(result.mesh, mesh), 0.002);
    const SurfaceCoverage covered = measure_coverage(result.report.views.visible_points, result.mesh, mesh.transform,
                                                     result.report.spacing, *scheduler);
    EXPECT_GT(covered.share, 0.999);
    EXPECT_LT(covered.rms, 0.1 * result.report.spacing);
    EXPECT_LE(covered.rms, covered.max);
  }
}

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

TEST(Reconstruct, IsTheSameForAnyNumberOfThreads) {
  const IndexedMesh mesh = sphere_mesh(4, 0.2);
  const auto serial = make_serial_scheduler();
  for (const MergeKind merge : {MergeKind::stitch, MergeKind::concatenate}) {
    ReconstructConfig config = small_config(130);  // zipped in a dozen tiles and more
    config.views.candidates = 200;
    config.merge = merge;
    const RawMesh expected = reconstruct(mesh, config, *serial).mesh;
    for (const int threads : {1, 2, 3, 7}) {
      const RawMesh other = reconstruct(mesh, config, *make_tbb_scheduler(threads)).mesh;
      EXPECT_EQ(expected.positions, other.positions);
      EXPECT_EQ(expected.triangles, other.triangles);
    }
  }
}

// Thinner than a pixel, with folds: its two sides come near each other all over, and each has holes of its own.
TEST(Reconstruct, ThinPartsGetNoHandles) {
  const auto scheduler = make_tbb_scheduler(2);
  for (const double resolution : {24.0, 40.0}) {
    IndexedMesh mesh = sphere_mesh(5, 0.2);
    for (Vec3f& p : mesh.positions) p.z = 0.3f + 0.02f * (p.z - 0.5f) + 0.12f * std::sin(14 * p.x) * std::sin(11 * p.y);
    const Reconstruction result = reconstruct(mesh, small_config(resolution), *scheduler);
    const MeshQuality quality = measure_quality(result.mesh.positions, result.mesh.triangles);
    EXPECT_TRUE(quality.closed() && quality.manifold());
    EXPECT_EQ(quality.euler, 2);
    EXPECT_EQ(quality.components, 1u);
    EXPECT_EQ(result.report.stitch.handles, 0u);
    expect_half_edges_hold(result.mesh);
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

TEST(Reconstruct, DoesNotMindARotation) {
  const IndexedMesh mesh = sphere_mesh(5, 0.15);
  const double c = std::cos(0.7), s = std::sin(0.7);
  const Vec3d middle{0.5, 0.5, 0.5};
  const auto turn = [&](Vec3d v) { return Vec3d{c * v.x - s * v.y, s * v.x + c * v.y, v.z}; };
  IndexedMesh turned = mesh;
  for (Vec3f& p : turned.positions) p = to_float(middle + turn(to_double(p) - middle));
  const auto serial = make_serial_scheduler();
  const auto merged = [&](const IndexedMesh& m, auto move) {
    DrawnMaps drawn;
    drawn.closed = true;
    for (const Vec3d& direction : face_directions()) {
      MapView view = orthographic_view(box_of(mesh), direction, 1.0 / 50);
      move(view);
      drawn.maps.push_back(rasterize_map(m, view, {}, *serial));
    }
    drawn.links.resize(6), drawn.vertices.resize(6);
    ReconstructConfig config;
    ReconstructReport report;
    report.spacing = 1.0 / 50;
    return mesh_from_maps(drawn, nullptr, config, report, *serial);
  };
  const RawMesh straight = merged(mesh, [](MapView&) {});
  RawMesh back = merged(turned, [&](MapView& v) {
    v.eye = middle + turn(v.eye - middle);
    v.right = turn(v.right), v.up = turn(v.up), v.forward = turn(v.forward);
  });
  const Vec3d centre = mesh.transform.to_model(to_float(middle));
  for (Vec3d& p : back.positions) {
    const Vec3d d = p - centre;
    p = centre + Vec3d{c * d.x + s * d.y, -s * d.x + c * d.y, d.z};
  }
  EXPECT_NEAR(static_cast<double>(straight.triangles.size()), static_cast<double>(back.triangles.size()),
              0.01 * static_cast<double>(straight.triangles.size()));
  const MeshDistance d = compare_meshes(straight, back);
  EXPECT_LT(std::max(d.forward.rms, d.backward.rms) / d.diagonal, 2e-4);
}

TEST(Reconstruct, KeepsAbuttingModelsApart) {
  IndexedMesh one = sphere_mesh(4, 0);
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  for (int k = 0; k < 2; ++k) {  // two balls that touch
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const Vec3f& p : one.positions) positions.push_back({p.x + 1.0001 * k, p.y, p.z});
    for (const Triangle& t : one.triangles) triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
  }
  const IndexedMesh mesh = clean(positions, triangles);
  const auto serial = make_serial_scheduler();
  const Reconstruction result = reconstruct(mesh, small_config(60), *serial);
  const MeshQuality quality = measure_quality(result.mesh.positions, result.mesh.triangles);
  EXPECT_TRUE(quality.manifold());
  EXPECT_EQ(quality.components, 2u);
  for (const Triangle& t : result.mesh.triangles) {
    const auto side = [&](std::uint32_t v) { return result.mesh.positions[v].x > 1.00005; };
    EXPECT_TRUE(side(t.v[0]) == side(t.v[1]) && side(t.v[1]) == side(t.v[2]));
  }
}

TEST(Reconstruct, OpenSurfacesStayOpen) {
  const IndexedMesh mesh = terrain_mesh(40, 0.2);
  const auto serial = make_serial_scheduler();
  const Reconstruction result = reconstruct(mesh, small_config(50), *serial);
  const MeshQuality quality = measure_quality(result.mesh.positions, result.mesh.triangles);
  EXPECT_TRUE(quality.manifold());
  EXPECT_EQ(quality.components, 1u);
  EXPECT_EQ(quality.euler, 1);  // a disk
  const double outline = measure_quality(original(mesh).positions, mesh.triangles).border_length;
  EXPECT_NEAR(quality.border_length, outline, 0.2 * outline);
  std::size_t down = 0;  // along seams on slopes of 70 degrees a triangle may hang over
  for (const Triangle& t : result.mesh.triangles) {
    const auto& p = result.mesh.positions;
    down += cross(p[t.v[1]] - p[t.v[0]], p[t.v[2]] - p[t.v[0]]).z <= 0;
  }
  EXPECT_LT(down, result.mesh.triangles.size() / 200);
}

TEST(Reconstruct, HardInputGivesSoundResults) {
  const auto serial = make_serial_scheduler();
  std::vector<IndexedMesh> meshes{terrain_mesh(3, 0), sphere_mesh(0)};
  IndexedMesh far = sphere_mesh(4);
  far.transform.origin = {1e7, -3e7, 2e7};
  meshes.push_back(far);
  IndexedMesh tiny = sphere_mesh(4);
  tiny.transform.scale = 1e-9;
  meshes.push_back(tiny);
  IndexedMesh twice = sphere_mesh(4);  // coincident surfaces, facing both ways
  for (const Triangle t : std::vector<Triangle>(twice.triangles)) twice.triangles.push_back({{t.v[0], t.v[2], t.v[1]}});
  meshes.push_back(twice);
  IndexedMesh grazing = terrain_mesh(20, 0);  // a thin wedge, seen from its edge by four faces
  for (Vec3f& p : grazing.positions) p.z = 1e-4f * p.x;
  meshes.push_back(grazing);
  meshes.push_back(clean({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}));
  for (const IndexedMesh& mesh : meshes)
    for (const MergeKind merge : {MergeKind::stitch, MergeKind::concatenate}) {
      ReconstructConfig config = small_config(30);
      config.merge = merge;
      config.extend = true;
      const Reconstruction result = reconstruct(mesh, config, *serial);
      expect_sound(result.mesh);
      EXPECT_FALSE(result.mesh.triangles.empty());
      EXPECT_TRUE(merge == MergeKind::concatenate ||
                  measure_quality(result.mesh.positions, result.mesh.triangles).manifold());
      EXPECT_LT(diagonal_share(result.mesh, mesh), 0.05);
    }
}

TEST(Reconstruct, NothingSeenGivesAnEmptyMesh) {
  const auto serial = make_serial_scheduler();
  // A line of triangles without area.
  IndexedMesh mesh;
  mesh.positions = {{0, 0, 0}, {0.5f, 0, 0}, {1, 0, 0}};
  mesh.triangles = {{{0, 1, 2}}};
  const Reconstruction result = reconstruct(mesh, small_config(20), *serial);
  EXPECT_TRUE(result.mesh.triangles.empty() && result.mesh.positions.empty());
  EXPECT_EQ(result.report.seen, 0u);
}

TEST(Reconstruct, MeetsATriangleTarget) {
  const auto scheduler = make_tbb_scheduler(2);
  const Reconstruction result = reconstruct_to_triangles(sphere_mesh(5), small_config(256), 6000, *scheduler);
  EXPECT_NEAR(static_cast<double>(result.mesh.triangles.size()), 6000, 300);
  ReconstructConfig plain = small_config(256);
  plain.detail = 1;
  const RawMesh sampled = reconstruct_to_triangles(sphere_mesh(5), plain, 6000, *scheduler).mesh;
  EXPECT_NEAR(static_cast<double>(sampled.triangles.size()), 6000, 300);
}

// Two specks, at the ends of a long box: no resolution that is tried has a pixel for them.
TEST(Reconstruct, DrawsNothingOfWhatIsSmallerThanAPixel) {
  const auto serial = make_serial_scheduler();
  IndexedMesh mesh;
  mesh.positions = {{0, 0, 0}, {1e-6f, 0, 0}, {0, 1e-6f, 0}, {1, 0, 0}, {1, 1e-6f, 0}, {1, 0, 1e-6f}};
  mesh.triangles = {{{0, 1, 2}}, {{3, 4, 5}}};
  for (const MergeKind merge : {MergeKind::stitch, MergeKind::shell}) {
    ReconstructConfig config = small_config(256);
    config.merge = merge;
    const Reconstruction result = reconstruct_to_triangles(mesh, config, 500, *serial);
    EXPECT_TRUE(result.mesh.triangles.empty());
    EXPECT_EQ(result.report.pixels, 0u);
  }
}

// Separate triangles cannot be made of fewer: no resolution is tried for that.
TEST(Reconstruct, SamplesPartsThatCannotBeSimplified) {
  const auto serial = make_serial_scheduler();
  IndexedMesh mesh;
  for (std::uint32_t k = 0; k < 4000; ++k) {
    const Vec3f p{static_cast<float>(k % 16) / 16, static_cast<float>(k / 16 % 16) / 16,
                  static_cast<float>(k / 256) / 16};
    for (const Vec3f& d : {Vec3f{0, 0, 0}, Vec3f{0.02f, 0, 0}, Vec3f{0, 0.02f, 0.01f}}) mesh.positions.push_back(p + d);
    mesh.triangles.push_back({{3 * k, 3 * k + 1, 3 * k + 2}});
  }
  const Reconstruction result = reconstruct_to_triangles(mesh, small_config(256), 200, *serial);
  EXPECT_GT(result.mesh.triangles.size(), 2000u);
  EXPECT_LT(result.report.drawn_resolution, 64);
}

TEST(Reconstruct, CoarserFromFartherAway) {
  const IndexedMesh mesh = sphere_mesh(2);
  EXPECT_NEAR(resolution_at_distance(mesh, 20) / resolution_at_distance(mesh, 40), 2, 1e-9);
  EXPECT_THROW((void)resolution_at_distance(mesh, 0), InputError);
}

TEST(Reconstruct, RefusesConfigsOutOfRange) {
  const IndexedMesh mesh = sphere_mesh(2);
  const auto serial = make_serial_scheduler();
  const auto refused = [&](auto change) {
    ReconstructConfig config = small_config(20);
    change(config);
    EXPECT_THROW((void)reconstruct(mesh, config, *serial), InputError);
  };
  refused([](ReconstructConfig& c) { c.resolution = 1; });
  refused([](ReconstructConfig& c) { c.resolution = std::nan(""); });
  refused([](ReconstructConfig& c) { c.detail = 0.5; });
  refused([](ReconstructConfig& c) { c.detail = 17; });
  refused([](ReconstructConfig& c) { c.max_slope = 0; });
  refused([](ReconstructConfig& c) { c.slack = -1; });
  refused([](ReconstructConfig& c) { c.sharp_degrees = 180; });
  refused([](ReconstructConfig& c) { c.views.most = 0; });
  refused([](ReconstructConfig& c) { c.backend = "null"; });
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
