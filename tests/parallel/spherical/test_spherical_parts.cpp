// Meshes of many components over the sphere: images of their own, an atlas, or none.
#include <gtest/gtest.h>

#include "core/progressive/gltf/progressive_glb.h"
#include "core/texture/image_codec.h"
#include "parallel/clean/prepare.h"
#include "tests/parallel/spherical/made_spherical.h"
#include "tests/test_meshes.h"

namespace lodestone::test {
namespace {

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

TEST(SphericalParts, GivesEachComponentImagesByItsSize) {
  const Made made = make(two_spheres(), small_images());
  EXPECT_EQ(made.report.topology.components, 2u);
  ASSERT_EQ(made.mesh.wedges.materials.size(), 2u);
  std::vector<std::uint32_t> sides;
  for (const std::uint32_t texture : made.mesh.object_normals)
    sides.push_back(image_size(made.mesh.wedges.textures[texture].bytes, "image/png").width);
  EXPECT_EQ(sides, (std::vector<std::uint32_t>{128, 32}));
  EXPECT_EQ(kind_by_position(made.mesh, made.mesh.triangles).components, 2u);
}

TEST(SphericalParts, LeavesOutTheSmallestComponents) {
  SphericalConfig config = small_images();
  config.components = 1;
  const Made one = make(two_spheres(), config);
  EXPECT_EQ(one.report.topology.components, 2u);
  EXPECT_EQ(one.report.left_out, 1u);
  EXPECT_EQ(one.mesh.wedges.materials.size(), 1u);
  EXPECT_EQ(kind_by_position(one.mesh, one.mesh.triangles).components, 1u);
  config.components = 2;
  const Made two = make(two_spheres(), config);
  EXPECT_EQ(two.report.left_out, 0u);
  EXPECT_NEAR(area_of(one.mesh.positions, one.mesh.triangles, one.mesh.transform) * 1.04,
              area_of(two.mesh.positions, two.mesh.triangles, two.mesh.transform), 1e-3);
}

// A large sphere with many small ones around it, of several sizes.
IndexedMesh sphere_with_crumbs() {
  RawMesh raw;
  const auto add = [&](const IndexedMesh& sphere, double scale, Vec3d shift) {
    const auto first = static_cast<std::uint32_t>(raw.positions.size());
    for (const Vec3f p : sphere.positions) raw.positions.push_back(scale * to_double(p) + shift);
    for (const Triangle& t : sphere.triangles)
      raw.triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
  };
  add(sphere_mesh(4), 1, {});
  for (int k = 0; k < 20; ++k) add(sphere_mesh(k % 3), k % 2 == 0 ? 0.01 : 0.04, {2, 0.1 * k, 0});
  Repairs repairs;
  return prepare_mesh(std::move(raw), repairs, *make_serial_scheduler());
}

TEST(SphericalParts, SmallComponentsShareTheirImages) {
  const IndexedMesh mesh = sphere_with_crumbs();
  const Made made = make(mesh, small_images());
  EXPECT_EQ(made.report.topology.components, 21u);
  ASSERT_EQ(made.mesh.wedges.materials.size(), 2u);
  EXPECT_EQ(made.mesh.object_normals.size(), 2u);
  EXPECT_EQ(made.report.map.sums.flips, 0u);
  EXPECT_GT(made.report.normal_psnr, 35);
  expect_square(made.mesh);
  EXPECT_EQ(kind_by_position(made.mesh, made.mesh.triangles).components, 21u);
  EXPECT_EQ(kind_by_position(made.mesh, made.mesh.triangles).open_edges, 0u);
  const std::vector<std::byte> bytes = encode_progressive_glb(made.mesh, false);
  for (const int threads : {2, 3})
    EXPECT_EQ(encode_progressive_glb(make(mesh, small_images(), threads).mesh, false), bytes);
  SphericalConfig config = small_images();  // a geometry image is that of one component
  config.maps.geometry = true;
  EXPECT_EQ(make(mesh, config).mesh.wedges.materials.size(), 21u);
}

// In a row, all of the same size.
IndexedMesh row_of(const IndexedMesh& one, int count) {
  RawMesh raw;
  for (int k = 0; k < count; ++k) {
    const auto first = static_cast<std::uint32_t>(raw.positions.size());
    for (const Vec3f p : one.positions) raw.positions.push_back(to_double(p) + Vec3d{3.0 * k, 0, 0});
    for (const Triangle& t : one.triangles) raw.triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
  }
  Repairs repairs;
  return prepare_mesh(std::move(raw), repairs, *make_serial_scheduler());
}

// Each would have images of the whole side.
TEST(SphericalParts, PartsOfFewTrianglesShareSmallImages) {
  SphericalConfig config = small_images();
  config.texture = 1024;
  const Made made = make(row_of(sphere_mesh(1), 40), config);
  EXPECT_EQ(made.report.topology.components, 40u);
  EXPECT_EQ(made.report.plain, 0u);
  EXPECT_EQ(made.mesh.wedges.materials.size(), 1u);
  EXPECT_GT(made.report.pixels, 0u);
  EXPECT_LE(made.report.pixels, 2u * 1024 * 1024);
}

// Octahedra; triangles from both sides, of which edges are halved; a sphere that is mapped as ever.
TEST(SphericalParts, ManyPartsOfAFewTrianglesHaveNoImages) {
  const IndexedMesh octahedra = row_of(sphere_mesh(0), 30),
                    sheets = row_of(normalised({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}, {{0, 2, 1}}}), 30);
  for (const IndexedMesh& mesh : {octahedra, sheets}) {
    const Made made = make(mesh, small_images());
    EXPECT_EQ(made.report.topology.components, 30u);
    EXPECT_EQ(made.report.plain, 30u);
    EXPECT_EQ(made.report.pixels, 0u);
    ASSERT_EQ(made.mesh.wedges.materials.size(), 1u);
    EXPECT_EQ(made.mesh.octahedral, std::vector<std::optional<OctahedralLayout>>(1));
    EXPECT_EQ(kind_by_position(made.mesh, made.mesh.triangles).components, 30u);
    EXPECT_NEAR(area_of(made.mesh.positions, made.mesh.triangles, made.mesh.transform),
                area_of(mesh.positions, mesh.triangles, mesh.transform), 1e-3);
    const std::vector<std::byte> bytes = encode_progressive_glb(made.mesh, false);
    EXPECT_EQ(encode_progressive_glb(make(mesh, small_images(), 3).mesh, false), bytes);
    EXPECT_EQ(make(row_of(sphere_mesh(0), 15), small_images()).report.plain, 0u);
  }
  SphericalConfig config = small_images();
  config.components = 20;
  EXPECT_EQ(make(octahedra, config).report.plain, 20u);
  config.maps.geometry = true;  // an image for each
  EXPECT_EQ(make(octahedra, config).report.plain, 0u);
  IndexedMesh coloured = octahedra;
  coloured.wedges.colour.assign(coloured.positions.size(), {255, 0, 0, 255});
  EXPECT_EQ(make(coloured, small_images()).report.plain, 0u);
}

TEST(SphericalParts, PartsWithoutImagesAreBesideThoseThatHaveThem) {
  RawMesh raw;
  for (const IndexedMesh& from : {row_of(sphere_mesh(0), 30), sphere_mesh(4)}) {
    const auto first = static_cast<std::uint32_t>(raw.positions.size());
    for (const Vec3f p : from.positions) raw.positions.push_back(from.transform.to_model(p) + Vec3d{0, 0.0 + first, 0});
    for (const Triangle& t : from.triangles)
      raw.triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
  }
  Repairs repairs;
  const Made made = make(prepare_mesh(std::move(raw), repairs, *make_serial_scheduler()), small_images());
  EXPECT_EQ(made.report.plain, 30u);
  ASSERT_EQ(made.mesh.wedges.materials.size(), 2u);
  ASSERT_EQ(made.mesh.object_normals.size(), 2u);
  EXPECT_EQ(made.mesh.object_normals[1], no_texture);
  EXPECT_TRUE(made.mesh.octahedral.at(0) && !made.mesh.octahedral.at(1));
  EXPECT_GT(made.report.normal_psnr, 35);
  EXPECT_GT(made.report.efficiency, 0.9);
  EXPECT_EQ(kind_by_position(made.mesh, made.mesh.triangles).open_edges, 0u);
}

}  // namespace
}  // namespace lodestone::test
