// The whole way from a mesh to one over the sphere: the surface is the input's, images are seamless and right.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/base/error.h"
#include "core/formats/gltf/gltf_surface.h"
#include "core/mesh/uv_map.h"
#include "core/progressive/gltf/progressive_glb.h"
#include "core/progressive/mesh/level.h"
#include "core/spatial/mesh_distance.h"
#include "core/spherical/octahedron/octahedral_image.h"
#include "core/spherical/octahedron/octahedral_map.h"
#include "core/spherical/resample/geometry_image.h"
#include "core/spherical/resample/octahedral_codec.h"
#include "parallel/clean/prepare.h"
#include "parallel/spherical/carried_surface.h"
#include "parallel/spherical/make_spherical.h"
#include "tests/core/spherical/painted_sphere.h"
#include "tests/expect_error.h"
#include "tests/parallel/spherical/made_spherical.h"
#include "tests/test_meshes.h"

namespace lodestone::test {
namespace {

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

Texture flat_texture(std::array<std::uint8_t, 4> pixel) {
  PixelImage image{.size = {8, 8}, .channels = 4, .pixels = {}};
  for (int p = 0; p < 64; ++p) image.pixels.insert(image.pixels.end(), pixel.begin(), pixel.end());
  return texture_of(image);
}

// Half of a sphere each: all of their images, and the factors that differ, are in images over the square.
IndexedMesh sphere_of_two_materials() {
  IndexedMesh mesh = painted_sphere(5).mesh;
  mesh.wedges.textures = {flat_texture({9, 200, 100, 255}), flat_texture({120, 0, 0, 255}),
                          flat_texture({255, 188, 0, 0})};
  Material a{.name = "a",
             .metallic = 1,
             .roughness = 0.5f,
             .metallic_roughness = {0, {}},
             .occlusion = {1, {}},
             .occlusion_strength = 0.5f,
             .emissive = {1, 0.5f, 0}};
  Material b{.name = "b", .metallic = 0.2f, .roughness = 0.8f, .emissive = {0.5f, 1, 1}, .emissive_map = {2, {}}};
  b.extensions = R"({"KHR_materials_emissive_strength":{"emissiveStrength":2.0}})";
  mesh.wedges.materials = {a, b};
  mesh.wedges.material.resize(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    float x = 0;
    for (const std::uint32_t w : t.v) x += mesh.positions[w].x / 3;
    for (const std::uint32_t w : t.v) mesh.wedges.material[w] = x > 0.5f ? 0 : 1;
  }
  return mesh;
}

TEST(MakeSpherical, DrawsAllImagesOfItsMaterials) {
  SphericalConfig config = small_images();
  for (const std::string type : {"image/png", "image/webp"}) {
    config.media_type = type;
    const float allowed = type == "image/png" ? 0.005f : 0.05f;  // lossy codes ring beside the border of the halves
    const Made made = make(sphere_of_two_materials(), config);
    EXPECT_TRUE(made.report.left_out_features.empty()) << *made.report.left_out_features.begin();
    ASSERT_EQ(made.mesh.wedges.materials.size(), 1u);
    const Material& m = made.mesh.wedges.materials[0];
    EXPECT_EQ(m.metallic + m.roughness + m.occlusion_strength + m.emissive[1], 4);
    EXPECT_EQ(emissive_strength(m), 2);
    EXPECT_EQ(m.occlusion.texture, m.metallic_roughness.texture);
    std::uint64_t bytes = 0;
    const auto image = [&](std::uint32_t number, PixelMeaning meaning) {
      const Texture& texture = made.mesh.wedges.textures.at(number);
      bytes += texture.bytes.size();
      return spherical::decode_octahedral(texture.bytes, meaning, texture.media_type, {});
    };
    const LinearImage surface = image(m.occlusion.texture, PixelMeaning::values),
                      light = image(m.emissive_map.texture, PixelMeaning::colours);
    EXPECT_EQ(made.report.material_bytes, bytes);
    ASSERT_EQ(surface.channels + light.channels, 6u);
    std::size_t count = 0;
    for (std::uint32_t v = 0; v < made.mesh.vertex_count(); ++v) {
      const float x = made.mesh.positions[v].x;
      if (std::abs(x - 0.5f) < 0.1f) continue;
      ++count;
      const Vec2f uv = made.mesh.wedges.uv[v];
      const std::array<float, 4> values = spherical::sample(surface, {uv.x, uv.y}),
                                 own = spherical::sample(light, {uv.x, uv.y});
      const std::array<float, 3> expected = x > 0.5f ? std::array{0.5f + 60.0f / 255, 100.0f / 255, 100.0f / 255}
                                                     : std::array{1.0f, 0.8f, 0.2f},
                                 emitted = x > 0.5f ? std::array{0.5f, 0.25f, 0.0f} : std::array{0.5f, 0.5029f, 0.0f};
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(values[c], expected[c], allowed) << type << c << ' ' << x;
        EXPECT_NEAR(own[c], emitted[c], allowed) << type << c << ' ' << x;
      }
    }
    EXPECT_GT(count, 1000u);
  }
  // Only what the input has, and only with colours.
  EXPECT_EQ(make(painted_sphere(5).mesh, small_images()).report.material_bytes, 0u);
  config.maps = spherical_maps("normal");
  const Made normals = make(sphere_of_two_materials(), config);
  EXPECT_EQ(normals.report.material_bytes, 0u);
  EXPECT_EQ(normals.report.left_out_features.size(), 6u);
}

// A transform of an image's own moves it, and it alone.
TEST(MakeSpherical, DrawsImagesWhereTheirTransformsPutThem) {
  PaintedSphere painted = painted_sphere(5);
  Material& m = painted.mesh.wedges.materials[0];
  m.emissive = {1, 1, 1};
  m.emissive_map = {0, {.offset = {0.25f, 0.5f}, .scale = {0.5f, 2}, .rotation = 0.5f}};
  const UvMap place = map_of(m.emissive_map.transform);
  IndexedMesh moved = painted.mesh;
  for (Vec2f& uv : moved.wedges.uv)
    uv = {static_cast<float>(place[0] * uv.x + place[1] * uv.y + place[4]),
          static_cast<float>(place[2] * uv.x + place[3] * uv.y + place[5])};
  moved.wedges.materials[0].emissive_map.transform = {};
  const Made made = make(painted.mesh, small_images()), twin = make(moved, small_images());
  const auto light = [](const Made& of) {
    return of.mesh.wedges.textures.at(of.mesh.wedges.materials[0].emissive_map.texture).bytes;
  };
  EXPECT_EQ(light(made), light(twin));
  EXPECT_EQ(made.mesh.wedges.textures[0].bytes,
            make(painted_sphere(5).mesh, small_images()).mesh.wedges.textures[0].bytes);
}

// Alpha counts in colours that are not opaque, the base colour's as well as the texture's.
TEST(MakeSpherical, KeepsAlphaWhereItCounts) {
  for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend}) {
    IndexedMesh mesh = painted_sphere(4).mesh;
    mesh.wedges.textures = {flat_texture({200, 100, 50, 128})};
    mesh.wedges.materials[0].base_colour[3] = 0.5f;
    mesh.wedges.materials[0].alpha_mode = mode;
    SphericalConfig config = small_images();
    config.media_type = "image/png";
    const Made made = make(mesh, config);
    const Material& m = made.mesh.wedges.materials[0];
    EXPECT_EQ(m.alpha_mode, mode);
    EXPECT_EQ(m.base_colour[3], 1);
    const PixelImage image = decode_image(made.mesh.wedges.textures[m.texture].bytes, "image/png");
    const std::uint8_t* const pixel = &image.pixels[image.channels * (image.size.width * 5 + 7)];
    ASSERT_EQ(image.channels, mode == AlphaMode::opaque ? 3u : 4u);
    EXPECT_NEAR(pixel[0], 200, 1);
    EXPECT_NEAR(pixel[2], 50, 1);
    if (mode != AlphaMode::opaque) {
      EXPECT_NEAR(pixel[3], 64, 1);
    }
  }
}

TEST(MakeSpherical, KeepsTheFactorsOfItsMaterial) {
  PaintedSphere painted = painted_sphere(5);
  Material& source = painted.mesh.wedges.materials[0];
  source.metallic = 0.25f, source.roughness = 0.5f;
  source.alpha_mode = AlphaMode::mask, source.alpha_cutoff = 0.75f;
  source.double_sided = source.unlit = true;
  source.extensions = R"({"KHR_materials_ior":{"ior":1.25}})";
  const Made made = make(painted.mesh, small_images());
  Material expected = source;
  expected.name = "octahedral";
  EXPECT_EQ(made.mesh.wedges.materials, std::vector<Material>{expected});
  EXPECT_TRUE(made.report.left_out_features.empty());
}

// Colours that are the same everywhere are in the material; others are in an image, and only if they are asked for.
TEST(MakeSpherical, DrawsOnlyTheColoursThatItNeeds) {
  IndexedMesh sphere = sphere_mesh(4);
  Material red;
  red.base_colour = {1, 0.25f, 0.25f, 1};
  sphere.wedges.materials = {red};
  const Made plain = make(sphere, small_images());
  ASSERT_EQ(plain.mesh.wedges.textures.size(), 1u);
  EXPECT_EQ(plain.mesh.wedges.materials[0].base_colour, red.base_colour);
  EXPECT_EQ(plain.mesh.wedges.materials[0].texture, no_texture);
  EXPECT_EQ(plain.mesh.object_normals, std::vector<std::uint32_t>{0});
  EXPECT_EQ(plain.report.colour_bytes, 0u);
  EXPECT_GT(plain.report.normal_psnr, 35);
  sphere.wedges.materials.push_back({});
  sphere.wedges.material.assign(sphere.positions.size(), 0);
  for (const std::uint32_t v : sphere.triangles[0].v) sphere.wedges.material[v] = 1;
  EXPECT_EQ(make(sphere, small_images()).mesh.wedges.textures.size(), 2u);
  SphericalConfig normals = small_images();
  normals.maps = spherical_maps("normal");
  const Made painted = make(painted_sphere(5).mesh, normals), both = make(painted_sphere(5).mesh, small_images());
  EXPECT_EQ(painted.report.colour_bytes, 0u);
  EXPECT_EQ(painted.report.colour_psnr, 0);
  ASSERT_EQ(painted.mesh.wedges.textures.size(), 1u);
  EXPECT_EQ(painted.mesh.wedges.textures[0].bytes, both.mesh.wedges.textures[1].bytes);
}

TEST(CarriedSurface, IsWhatTheMaterialsHaveInCommon) {
  IndexedMesh mesh;
  Material a{.name = "a", .metallic = 0.5f, .roughness = 0.25f, .double_sided = true}, b = a, c = a;
  b.roughness = 0.75f;
  c.metallic_roughness.texture = c.emissive_map.texture = c.occlusion.texture = 0;
  c.emissive = {1, 1, 1};
  c.extensions = "{}", c.extension_textures = {0};
  mesh.wedges.materials = {a, b, c};
  std::set<std::string> left_out;
  const Material same = carried_surface(mesh, {0}, {}, left_out), two = carried_surface(mesh, {0, 1}, {}, left_out);
  EXPECT_EQ(same.metallic + same.roughness, 0.75f);
  EXPECT_EQ(two.metallic, 0.5f);
  EXPECT_EQ(two.roughness, Material{}.roughness);
  EXPECT_TRUE(two.double_sided);
  EXPECT_EQ(left_out.size(), 1u);
  left_out.clear();
  Material bare = carried_surface(mesh, {2}, {}, left_out);
  EXPECT_EQ(left_out.size(), 4u);
  bare.extension_textures.clear();
  Material expected;
  expected.double_sided = true;
  EXPECT_EQ(bare, expected);
  EXPECT_EQ(carried_surface(mesh, {no_material}, {}, left_out), Material{});
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

// The images of positions that a file has, back from its bytes, are meshes near the input.
TEST(MakeSpherical, GivesGeometryImages) {
  const PaintedSphere painted = painted_sphere(5);
  SphericalConfig config = small_images();
  config.maps = spherical_maps("geometry");
  const Made made = make(painted.mesh, config);
  ASSERT_EQ(made.mesh.geometry_images.size(), 1u);
  EXPECT_TRUE(made.mesh.object_normals.empty());
  EXPECT_EQ(made.mesh.wedges.materials[0].texture, no_texture);
  const std::vector<std::byte> bytes = encode_progressive_glb(made.mesh, false);
  ByteReader input({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "test");
  const ProgressiveMesh back = read_progressive_glb(input);
  ASSERT_EQ(back.geometry_images, made.mesh.geometry_images);
  const auto& [texture, origin, step] = back.geometry_images[0];
  const WideImage image = decode_wide_png(back.wedges.textures[texture].bytes);
  EXPECT_EQ(image.size, (PixelSize{33, 33}));
  EXPECT_EQ(made.report.geometry_samples, 33u * 33u);
  EXPECT_EQ(made.report.geometry_bytes, back.wedges.textures[texture].bytes.size());
  RawMesh source;
  for (const Vec3f p : painted.mesh.positions) source.positions.push_back(painted.mesh.transform.to_model(p));
  source.triangles = painted.mesh.triangles;
  const MeshDistance distance =
      compare_meshes(source, spherical::remesh(spherical::geometry_of({image, origin, step})));
  EXPECT_LT(distance.forward.rms, 0.01 * distance.diagonal);
  EXPECT_NEAR(distance.forward.max / distance.diagonal, made.report.geometry_max, 1e-3);
  EXPECT_NEAR(distance.forward.rms / distance.diagonal, made.report.geometry_rms, 1e-3);
}

TEST(MakeSpherical, KnowsItsMapsByName) {
  const SphericalMaps some = spherical_maps("geometry,colour");
  EXPECT_TRUE(some.colour && some.geometry && !some.normal);
  EXPECT_EQ(to_string(some), "colour,geometry");
  for (const char* names : {"", "colour,", "Colour", "normal colour"})
    expect_error_of<InputError>([&] { (void)spherical_maps(names); }, {"unknown map", "colour,normal,geometry"});
}

// PNG holds normals with 16 bits, lossy formats with 8.
TEST(MakeSpherical, KeepsNormalsFinerInPng) {
  const IndexedMesh sphere = sphere_mesh(6);
  SphericalConfig config = small_images();
  config.texture = 512;
  const double fine = make(sphere, config).report.normal_psnr;
  config.media_type = "image/webp", config.quality = 100;
  EXPECT_GT(fine, make(sphere, config).report.normal_psnr + 3);
}

// Colour is stored at half the resolution, which would blur normals.
TEST(MakeSpherical, StacksNormalsInWebp) {
  const PaintedSphere painted = painted_sphere(6);
  SphericalConfig config = small_images();
  config.media_type = "image/webp";
  const auto size_at = [&](int quality) {
    config.quality = quality;
    const Made made = make(painted.mesh, config);
    EXPECT_GT(made.report.normal_psnr, 37) << quality;
    return image_size(made.mesh.wedges.textures[made.mesh.object_normals[0]].bytes, config.media_type);
  };
  EXPECT_EQ(size_at(90), (PixelSize{128, 384}));
  EXPECT_EQ(size_at(100), (PixelSize{128, 128}));  // nothing is halved without loss
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
