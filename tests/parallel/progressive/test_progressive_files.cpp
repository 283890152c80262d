// Files of progressive meshes of either kind: what they keep, and what is refused; glTF is back bit for bit.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/mesh/generate.h"
#include "core/progressive/gltf/progressive_glb.h"
#include "core/progressive/progressive_file.h"
#include "core/texture/image_codec.h"
#include "tests/expect_error.h"
#include "tests/parallel/progressive/progressive_meshes.h"
#include "tests/test_folder.h"

namespace lodestone::test {
namespace {

TEST(ProgressiveGlb, ComesBackBitForBit) {
  for (const ProgressiveMesh& mesh : some_progressive_meshes())
    for (const bool compressed : {false, true}) {
      const std::vector<std::byte> bytes = encode_progressive_glb(mesh, compressed);
      ByteReader input = reader_of(bytes);
      const ProgressiveMesh back = read_progressive_glb(input);
      EXPECT_EQ(back.positions, mesh.positions);
      EXPECT_EQ(back.parents, mesh.parents);
      EXPECT_EQ(back.triangles, mesh.triangles);
      EXPECT_EQ(back.base_vertices, mesh.base_vertices);
      EXPECT_EQ(back.wedges.uv, mesh.wedges.uv);
      EXPECT_EQ(back.wedges.normal, mesh.wedges.normal);
      Transform transform = mesh.transform;
      transform.up.guessed = false;  // written, it is the file's
      EXPECT_EQ(back.transform, transform);
      for (std::size_t v = 0; v < mesh.errors.size(); ++v) EXPECT_NEAR(back.errors[v], mesh.errors[v], 1e-6);
    }
}

// Half of the surface has a material; the reader must not give it to the rest.
TEST(ProgressiveFiles, KeepTrianglesWithoutAMaterial) {
  RawMesh raw = generate_mesh({Shape::sphere, 600, 1});
  raw.materials = {{.name = "red", .base_colour = {1, 0, 0, 1}}};
  for (std::size_t t = 0; t < raw.triangles.size(); ++t)
    raw.wedges.material.push_back(t < raw.triangles.size() / 2 ? 0 : no_material);
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  const ProgressiveMesh mesh = progressive_of(prepare_mesh(std::move(raw), repairs, *scheduler));
  const auto bare = [](const ProgressiveMesh& m) {
    return std::ranges::count_if(m.triangles, [&](const Triangle& t) {
      return !m.wedges.material.empty() && m.wedges.material[t.v[0]] == no_material;
    });
  };
  EXPECT_GT(bare(mesh), 0);
  for (const std::vector<std::byte>& bytes : {encode_progressive_glb(mesh, false), encode_lpm(mesh, {}).bytes}) {
    ByteReader input = reader_of(bytes);
    const ProgressiveMesh back = read_progressive(input);
    EXPECT_EQ(back.wedges.materials, mesh.wedges.materials);
    EXPECT_EQ(bare(back), bare(mesh));
  }
}

TEST(ProgressiveFiles, KeepMapsOverTheSphere) {
  ProgressiveMesh mesh = some_progressive_meshes().front();
  mesh.wedges.uv.assign(mesh.positions.size(), {});
  const PixelImage pixel{.size = {1, 1}, .channels = 3, .pixels = {1, 2, 3}};
  const std::vector<char> bytes = encode_image(pixel, "image/png");
  Material skin{.name = "skin", .texture = 0, .normal_scale = 0.5f, .metallic = 0.25f, .roughness = 0.5f};
  skin.normal_map = skin.occlusion.texture = 1;
  skin.emissive_map = {2, {{0.5f, 0}, {2, 2}, 0}};
  skin.emissive = {0.5f, 1, 0};
  skin.alpha_mode = AlphaMode::mask, skin.alpha_cutoff = 0.25f;
  skin.double_sided = skin.unlit = true;
  skin.extensions = R"({"KHR_materials_sheen":{"sheenColorTexture":{"index":0}}})";
  skin.extension_textures = {2};
  mesh.wedges.materials = {skin};
  mesh.wedges.textures = {{.name = "colour", .media_type = "image/png", .bytes = bytes},
                          {.name = "normals", .media_type = "image/png", .bytes = bytes},
                          {.name = "geometry", .media_type = "image/png", .bytes = bytes}};
  mesh.wedges.textures[1].mag_filter = 9728, mesh.wedges.textures[1].min_filter = 9984;
  mesh.object_normals = {1};
  mesh.geometry_images = {{2, {0.1, -2, 3e7}, 1.0 / 3}};
  mesh.octahedral = {OctahedralLayout{256, {{64, 2}, {16, 30}}}};
  const auto check = [&](ByteReader input) {
    const ProgressiveMesh back = read_progressive(input);
    EXPECT_EQ(back.object_normals, mesh.object_normals);
    EXPECT_EQ(back.geometry_images, mesh.geometry_images);
    EXPECT_EQ(back.octahedral, mesh.octahedral);
    EXPECT_EQ(back.wedges.materials, mesh.wedges.materials);
    EXPECT_EQ(back.wedges.textures, mesh.wedges.textures);
  };
  const std::vector<std::byte> glb = encode_progressive_glb(mesh, false), lpm = encode_lpm(mesh, {}).bytes;
  check(reader_of(glb));
  check(reader_of(lpm));
}

TEST(ProgressiveGlb, RefusesWhatFloatsCannotHold) {
  ProgressiveMesh mesh = progressive_of(sphere_mesh(3));
  mesh.transform.scale = 1e39;
  expect_error_of<InputError>([&] { return encode_progressive_glb(mesh, false, {}); }, {"so large", ".lpm"});
}

TEST(ProgressiveGlb, RefusesGltfWithoutParents) {
  const std::string text =
      R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
  ByteReader input({text.data(), text.size()}, "plain.gltf");
  expect_error_of<InputError>([&] { return read_progressive_glb(input); }, {"not progressive"});
}

TEST(ProgressiveFiles, ByExtension) {
  const TestFolder folder;
  const ProgressiveMesh mesh = progressive_of(sphere_mesh(3));
  for (const char* name : {"a.lpm", "a.GLB"}) {
    const ProgressiveFileSize size = save_progressive(mesh, folder / name);
    EXPECT_EQ(std::filesystem::file_size(folder / name), size.bytes);
    EXPECT_EQ(load_progressive(folder / name).positions.size(), mesh.positions.size());
  }
  EXPECT_THROW(save_progressive(mesh, folder / "a.ply"), UnsupportedError);
  EXPECT_THROW((void)load_progressive(folder / "none.lpm"), FileError);
}

// Messages of the checks for damaged values, for any kind of file.
TEST(ProgressiveFiles, ContradictionsAreNamed) {
  const ProgressiveMesh sound = progressive_of(sphere_mesh(2));
  const auto refused = [&](auto change, const char* what) {
    ProgressiveMesh mesh = sound;
    change(mesh);
    expect_error_of<InputError>([&] { check_progressive(mesh, "test"); }, {what}, what);
  };
  check_progressive(sound, "test");
  refused([](ProgressiveMesh& m) { m.parents.pop_back(); }, "not one per vertex");
  refused([](ProgressiveMesh& m) { m.base_vertices = 1u << 20; }, "base has more vertices");
  refused([](ProgressiveMesh& m) { m.parents.back() = m.vertex_count() - 1; }, "comes in after it");
  refused([](ProgressiveMesh& m) { m.errors.front() = -1; }, "not a distance");
  refused([](ProgressiveMesh& m) { m.errors.back() = 10; }, "larger than that of the vertex before");
  refused([](ProgressiveMesh& m) { m.positions[3].x = NAN; }, "not finite");
  refused([](ProgressiveMesh& m) { m.triangles[0].v[1] = 1u << 20; }, "there is no vertex");
}

}  // namespace
}  // namespace lodestone::test
