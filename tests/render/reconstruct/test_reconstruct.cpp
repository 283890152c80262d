// From a model to a new mesh: closed, manifold, and the same whatever does not matter.
#include <gtest/gtest.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <cmath>

#include "core/base/error.h"
#include "experiments/metrics/geometry/mesh_quality.h"
#include "experiments/metrics/geometry/surface_coverage.h"
#include "render/reconstruct/from_maps.h"
#include "render/reconstruct/views/choose_views.h"
#include "tests/render/reconstruct/small_reconstruction.h"

namespace lodestone::test {
namespace {

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

}  // namespace
}  // namespace lodestone::test
