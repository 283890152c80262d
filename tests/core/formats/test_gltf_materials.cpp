// Materials of glTF: what is read is written again, and what is not is said.
#include <gtest/gtest.h>

#include "core/formats/gltf/gltf.h"
#include "tests/core/formats/gltf_material_file.h"

namespace lodestone {
namespace {

using nlohmann::json;
constexpr auto gltf = MeshFormat::gltf;

TEST(GltfMaterials, EverythingIsRead) {
  const RawMesh mesh = read_material(rich_material());
  EXPECT_EQ(wedge_mistake(mesh), "");
  EXPECT_TRUE(mesh.warnings.empty());
  ASSERT_EQ(mesh.materials.size(), 1u);
  const Material& m = mesh.materials[0];
  const auto name_of = [&](std::uint32_t texture) { return mesh.textures.at(texture).name; };
  EXPECT_EQ(name_of(m.texture) + name_of(m.metallic_roughness.texture) + name_of(m.normal_map) +
                name_of(m.occlusion.texture) + name_of(m.emissive_map.texture),
            "01213");
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.normal_scale, 0.5f);
  EXPECT_EQ(m.occlusion_strength, 0.75f);
  EXPECT_EQ(m.emissive, (std::array{0.5f, 0.25f, 1.0f}));
  EXPECT_EQ(m.emissive_map.transform, (UvTransform{{0.5f, 0.25f}, {2, -3}, 0.5f}));
  EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(m.alpha_cutoff, 0.25f);
  EXPECT_TRUE(m.double_sided && m.unlit);
  ASSERT_EQ(m.extension_textures.size(), 2u);
  EXPECT_EQ(mesh.textures.size(), 6u) << "the last is not used";
  EXPECT_EQ(mesh.textures[0].mag_filter, 9728);
  EXPECT_EQ(mesh.textures[0].min_filter, 9987);
}

TEST(GltfMaterials, EverythingIsWrittenAgain) {
  RawMesh mesh = read_material(rich_material());
  const RawMesh back = written_and_read(mesh);
  EXPECT_EQ(back.materials, mesh.materials);
  EXPECT_EQ(back.textures, mesh.textures);
  EXPECT_EQ(back.wedges.uv, mesh.wedges.uv);
  // After others in a scene, its textures have other numbers.
  RawMesh both = read_material({{"normalTexture", {{"index", 6}}}});
  append_mesh(both, std::move(mesh), "");
  const RawMesh later = written_and_read(both);
  EXPECT_EQ(later.materials, both.materials);
  const Material &moved = later.materials[1], &first = back.materials[0];
  EXPECT_EQ(moved.extensions, first.extensions);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_EQ(later.textures.at(moved.extension_textures[k]).name, back.textures.at(first.extension_textures[k]).name);
}

// An extension of a textureInfo may name textures itself.
TEST(GltfMaterials, TexturesWithinTexturesAreWrittenAgain) {
  const json inner{{"EXT_inner", {{"innerTexture", {{"index", 6}}}}}};
  const RawMesh mesh =
      read_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                     {"extensions", {{"KHR_materials_x", {{"xTexture", {{"index", 4}, {"extensions", inner}}}}}}}});
  const Material& m = mesh.materials.at(0);
  ASSERT_EQ(m.extension_textures.size(), 2u);
  const RawMesh back = written_and_read(mesh);
  ASSERT_EQ(back.materials, mesh.materials);
  for (const std::uint32_t texture : m.extension_textures)
    EXPECT_EQ(back.textures.at(texture), mesh.textures.at(texture));
}

TEST(GltfMaterials, DeclareTheirExtensions) {
  const std::vector<std::byte> bytes = encode_glb(view_of(read_material(rich_material())));
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const char* name : {"unlit", "ior", "clearcoat"})
    EXPECT_NE(text.find(R"(KHR_materials_)" + std::string(name) + '"'), std::string::npos) << name;
  EXPECT_NE(text.find(R"("extensionsUsed":["KHR_)"), std::string::npos);
  EXPECT_EQ(text.find("extensionsRequired"), std::string::npos);
}

TEST(GltfMaterials, DefaultsAreThoseOfGltfAndNoMaterialIsNoMetal) {
  const RawMesh metal = read_material({{"name", "metal"}});
  EXPECT_EQ(metal.materials, (std::vector<Material>{{.name = "metal", .metallic = 1, .double_sided = false}}));
  EXPECT_EQ(written_and_read(metal).materials, metal.materials);
  RawMesh bare = metal;
  bare.materials.clear(), bare.wedges = {};
  const std::vector<std::byte> bytes = encode_glb(view_of(bare));
  EXPECT_NE(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()).find(R"("metallicFactor":0)"),
            std::string_view::npos);
  const RawMesh back = written_and_read(bare);
  EXPECT_TRUE(back.materials.empty()) << "what the writer adds is not a material of the model";
  EXPECT_TRUE(back.wedges.material.empty());
}

TEST(GltfMaterials, BlendAndOpaque) {
  for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::blend}) {
    const RawMesh mesh = read_material({{"name", "m"}, {"alphaMode", mode == AlphaMode::blend ? "BLEND" : "OPAQUE"}});
    EXPECT_EQ(mesh.materials.at(0).alpha_mode, mode);
    EXPECT_EQ(written_and_read(mesh).materials, mesh.materials);
  }
}

TEST(GltfMaterials, OtherFeaturesAreNamed) {
  GltfFile file = file_with({{"extensions", {{"EXT_other", json::object()}}}});
  file.push("animations", json::object());
  file.json["cameras"] = {json::object(), json::object()};
  file.json["extensions"] = {{"KHR_lights_punctual", {{"lights", json::array({json::object()})}}},
                             {"KHR_materials_variants", {{"variants", json::array({{{"name", "a"}}})}}}};
  const RawMesh mesh = read_bytes(file.glb(), gltf);
  for (const char* what : {"1 materials use EXT_other", "1 animations", "2 cameras", "1 lights", "1 variants"})
    expect_warning(mesh, {"file: ", what, "left out"});
  EXPECT_EQ(mesh.warnings.size(), 5u);
}

TEST(GltfMaterials, ImagesThatCannotBeDecodedAreNamedWhenRead) {
  GltfFile file = file_with({{"normalTexture", {{"index", 7}}}});
  const std::size_t view = file.view("\xabKTX 20\xbb\r\n\x1a\nrest");
  file.push("images", {{"bufferView", view}, {"mimeType", "image/ktx2"}, {"name", "web"}});
  file.push("textures", {{"extensions", {{"KHR_texture_basisu", {{"source", 7}}}}}});
  const RawMesh mesh = read_bytes(file.glb(), gltf);
  EXPECT_EQ(mesh.textures.at(0).media_type, "image/ktx2");
  expect_warning(mesh, {"file: images[7]: texture 'web' is KTX2", "give it as PNG, JPEG or WebP"});
  EXPECT_EQ(written_and_read(mesh).textures, mesh.textures);
}

TEST(GltfMaterials, Errors) {
  const auto expect = [](const json& material, std::string_view what) {
    expect_error<InputError>(file_with(material).glb(), gltf, {"file: materials[0]", what});
  };
  expect({{"alphaMode", "GLASS"}}, "unknown alpha mode 'GLASS'");
  expect({{"alphaMode", 3}}, "expected a string");
  expect({{"emissiveFactor", {1, 2}}}, "expected 3 numbers");
  expect({{"doubleSided", "yes"}}, "expected true or false");
  expect({{"occlusionTexture", {{"index", 70}}}}, "out of range");
  expect({{"extensions", {{"KHR_materials_x", {{"xTexture", {{"index", 70}}}}}}}}, "out of range");
  json deep = json::object();
  for (int k = 0; k < 40; ++k) deep = {{"a", deep}};
  expect({{"extensions", {{"KHR_materials_x", deep}}}}, "nested more than 16 deep");
}

}  // namespace
}  // namespace lodestone
