// The whole way from a mesh to one over the sphere: the surface is the input's, images are seamless and right.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/base/error.h"
#include "core/progressive/gltf/progressive_glb.h"
#include "core/progressive/mesh/level.h"
#include "core/spherical/octahedron/octahedral_map.h"
#include "parallel/clean/prepare.h"
#include "parallel/spherical/make_spherical.h"
#include "tests/core/spherical/painted_sphere.h"
#include "tests/test_meshes.h"

namespace lodestone::test {
namespace {

struct Made {
  ProgressiveMesh mesh;
  SphericalReport report;
};

Made make(const IndexedMesh& mesh, SphericalConfig config = {}, int threads = 1) {
  Made made;
  const auto scheduler = threads == 1 ? make_serial_scheduler() : make_tbb_scheduler(threads);
  made.mesh = make_spherical(mesh, config, *scheduler, made.report);
  return made;
}

SphericalConfig small_images() {
  SphericalConfig config;
  config.texture = 128;
  config.media_type = "image/png";
  config.error_points = 20000;
  return config;
}

// By position, as texture coordinates part the surface.
spherical::SurfaceKind kind_by_position(const ProgressiveMesh& mesh, std::span<const Triangle> triangles) {
  std::map<std::array<float, 3>, std::uint32_t> number;
  std::vector<Triangle> welded;
  for (const Triangle& t : triangles) {
    Triangle& w = welded.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f p = mesh.positions[t.v[k]];
      w.v[k] = number.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(number.size())).first->second;
    }
  }
  return spherical::kind_of(welded, number.size());
}

double area_of(const std::vector<Vec3f>& positions, std::span<const Triangle> triangles, const Transform& transform) {
  double area = 0;
  for (const Triangle& t : triangles) {
    const auto at = [&](std::size_t k) { return transform.to_model(positions[t.v[k]]); };
    area += 0.5 * length(cross(at(1) - at(0), at(2) - at(0)));
  }
  return area;
}

void expect_square(const ProgressiveMesh& mesh) {
  for (const Vec2f uv : mesh.wedges.uv) {
    ASSERT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1) << uv.x << ' ' << uv.y;
  }
}

TEST(MakeSpherical, CarriesColoursFromAnAtlas) {
  const PaintedSphere painted = painted_sphere(6);
  const Made made = make(painted.mesh, small_images());
  EXPECT_EQ(made.report.topology.components, 1u);
  EXPECT_EQ(made.report.map.sums.flips, 0u);
  EXPECT_GT(made.report.efficiency, 0.9);
  EXPECT_GT(made.report.colour_psnr, 38);
  EXPECT_GT(made.report.normal_psnr, 38);
  ASSERT_EQ(made.mesh.wedges.materials.size(), 1u);
  EXPECT_EQ(made.mesh.wedges.materials[0].texture, 0u);
  EXPECT_EQ(made.mesh.object_normals, std::vector<std::uint32_t>{1});
  expect_square(made.mesh);
  // The input's surface, cut where the arcs are, and closed at every level.
  EXPECT_NEAR(area_of(made.mesh.positions, made.mesh.triangles, made.mesh.transform),
              area_of(painted.mesh.positions, painted.mesh.triangles, painted.mesh.transform), 1e-5);
  const LevelFinder levels(made.mesh);
  for (const std::uint32_t vertices : {made.mesh.vertex_count(), made.mesh.vertex_count() / 4, 200u}) {
    const spherical::SurfaceKind kind = kind_by_position(made.mesh, levels.compute_level(vertices));
    EXPECT_EQ(kind.open_edges, 0u) << vertices;
    EXPECT_EQ(kind.euler, 2) << vertices;
  }
}

TEST(MakeSpherical, LeavesOutWhatClosedTheSurface) {
  const IndexedMesh torus = torus_mesh(60, 30), terrain = terrain_mesh(30);
  const Made ring = make(torus, small_images()), sheet = make(terrain, small_images());
  EXPECT_EQ(ring.report.topology.handles, 1u);
  EXPECT_EQ(sheet.report.topology.boundary_loops, 1u);
  EXPECT_EQ(kind_by_position(ring.mesh, ring.mesh.triangles).euler, 0);
  EXPECT_EQ(kind_by_position(ring.mesh, ring.mesh.triangles).open_edges, 0u);
  EXPECT_EQ(kind_by_position(sheet.mesh, sheet.mesh.triangles).euler, 1);
  for (const auto& [made, input] : {std::pair(&ring, &torus), std::pair(&sheet, &terrain)}) {
    expect_square(made->mesh);
    EXPECT_EQ(made->report.map.sums.flips, 0u);
    EXPECT_NEAR(area_of(made->mesh.positions, made->mesh.triangles, made->mesh.transform),
                area_of(input->positions, input->triangles, input->transform), 1e-4);
  }
}

// A large and a small sphere.
IndexedMesh two_spheres() {
  const IndexedMesh one = sphere_mesh(4);
  RawMesh raw;
  for (const double scale : {1.0, 0.2}) {
    const auto first = static_cast<std::uint32_t>(raw.positions.size());
    for (const Vec3f p : one.positions) raw.positions.push_back(scale * to_double(p) + Vec3d{2 - 2 * scale, 0, 0});
    for (const Triangle& t : one.triangles) raw.triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
  }
  Repairs repairs;
  return prepare_mesh(std::move(raw), repairs, *make_serial_scheduler());
}

TEST(MakeSpherical, GivesEachComponentImagesByItsSize) {
  const Made made = make(two_spheres(), small_images());
  EXPECT_EQ(made.report.topology.components, 2u);
  ASSERT_EQ(made.mesh.wedges.materials.size(), 2u);
  std::vector<std::uint32_t> sides;
  for (const Material& m : made.mesh.wedges.materials)
    sides.push_back(image_size(made.mesh.wedges.textures[m.texture].bytes, "image/png").width);
  EXPECT_EQ(sides, (std::vector<std::uint32_t>{128, 32}));
  EXPECT_EQ(kind_by_position(made.mesh, made.mesh.triangles).components, 2u);
}

// Triangles that face the other way are turned; two spheres that touch along an edge are cut apart there, and further
// edges with the same ends are halved: colours come from the right places nevertheless.
TEST(MakeSpherical, FollowsWhatWasTurnedAndCutApart) {
  PaintedSphere painted = painted_sphere(5);
  for (std::size_t t = 0; t < painted.mesh.triangles.size(); t += 7) {
    auto& v = painted.mesh.triangles[t].v;
    std::swap(v[1], v[2]);
  }
  const Made made = make(painted.mesh, small_images());
  EXPECT_GT(made.report.topology.manifold.turned_triangles, 0u);
  EXPECT_GT(made.report.colour_psnr, 38);
  std::vector<Vec3d> p{{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 0.3, 1}, {0.5, -1, 0}, {0.5, -0.3, -1}};
  std::vector<Triangle> t;
  for (const auto& [a, b] : {std::pair(2u, 3u), std::pair(4u, 5u)})
    for (const Triangle& side : {Triangle{{0, 1, a}}, Triangle{{1, 0, b}}, Triangle{{0, a, b}}, Triangle{{1, b, a}}})
      t.push_back(side);
  const Made pair = make(normalised(std::move(p), std::move(t)), small_images());
  EXPECT_EQ(pair.report.topology.manifold.nonmanifold_edges, 1u);
  EXPECT_EQ(pair.report.map.sums.flips, 0u);
}

TEST(MakeSpherical, GivesTheSameBytesForAnyNumberOfThreads) {
  const PaintedSphere painted = painted_sphere(5);
  const std::vector<std::byte> one = encode_progressive_glb(make(painted.mesh, small_images()).mesh, false);
  for (const int threads : {2, 3})
    EXPECT_EQ(encode_progressive_glb(make(painted.mesh, small_images(), threads).mesh, false), one);
}

TEST(MakeSpherical, RefusesImagesOfOtherSizes) {
  SphericalConfig config = small_images();
  for (const std::uint32_t side : {0u, 8u, 100u}) {
    config.texture = side;
    EXPECT_THROW((void)make(sphere_mesh(2), config), InputError);
  }
}

}  // namespace
}  // namespace lodestone::test
