// Materials of glTF: what is read is written again, and what is not is said.
#include <gtest/gtest.h>

#include "core/formats/gltf/gltf.h"
#include "core/hierarchy/lode/lode_format.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/mesh/raw_mesh.h"
#include "core/texture/downsample.h"
#include "core/texture/image_codec.h"
#include "tests/core/formats/gltf_test_util.h"
#include "tests/expect_error.h"

namespace lodestone {
namespace {

using nlohmann::json;
constexpr auto gltf = MeshFormat::gltf;

// A triangle with two sets of texture coordinates and this material, which may use textures 0 to 6.
GltfFile file_with(const json& material) {
  GltfFile file;
  const std::size_t position = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const std::size_t uv = file.floats({0, 0, 1, 0, 0.25f, 1}, "VEC2"), other = file.floats({0, 0, 0, 1, 1, 0}, "VEC2");
  for (std::size_t k = 0; k < 7; ++k) {
    const std::size_t view = file.view(png_bytes(std::to_string(k)));
    file.push("images", {{"bufferView", view}, {"mimeType", "image/png"}, {"name", std::to_string(k)}});
    file.push("textures", {{"source", k}, {"sampler", 0}});
  }
  file.push("samplers", {{"magFilter", 9728}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33648}});
  file.push("materials", material);
  file.show({{{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}, {"TEXCOORD_1", other}}}, {"material", 0}}});
  return file;
}

json placed(std::size_t texture, const json& transform) {
  return {{"index", texture}, {"extensions", {{"KHR_texture_transform", transform}}}};
}

// Every value differs from its default.
json rich_material() {
  return {{"name", "rich"},
          {"pbrMetallicRoughness",
           {{"baseColorFactor", {1, 0.5, 0.25, 0.75}},
            {"baseColorTexture", {{"index", 0}}},
            {"metallicFactor", 0.5},
            {"roughnessFactor", 0.25},
            {"metallicRoughnessTexture", {{"index", 1}}}}},
          {"normalTexture", {{"index", 2}, {"scale", 0.5}}},
          {"occlusionTexture", {{"index", 1}, {"strength", 0.75}}},
          {"emissiveFactor", {0.5, 0.25, 1}},
          {"emissiveTexture", placed(3, {{"offset", {0.5, 0.25}}, {"rotation", 0.5}, {"scale", {2, -3}}})},
          {"alphaMode", "MASK"},
          {"alphaCutoff", 0.25},
          {"doubleSided", true},
          {"extensions",
           {{"KHR_materials_unlit", json::object()},
            {"KHR_materials_ior", {{"ior", 1.25}}},
            {"KHR_materials_clearcoat",
             {{"clearcoatFactor", 0.5},
              {"clearcoatTexture", {{"index", 4}}},
              {"clearcoatNormalTexture",
               {{"index", 5}, {"scale", 2}, {"extensions", {{"KHR_texture_transform", {{"offset", {1, 0}}}}}}}}}}}}};
}

RawMesh read(const json& material) { return read_bytes(file_with(material).glb(), gltf); }
RawMesh written_and_read(const RawMesh& mesh) {
  const std::vector<std::byte> bytes = encode_glb(view_of(mesh));
  return read_bytes({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, gltf);
}

TEST(GltfMaterials, EverythingIsRead) {
  const RawMesh mesh = read(rich_material());
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
  RawMesh mesh = read(rich_material());
  const RawMesh back = written_and_read(mesh);
  EXPECT_EQ(back.materials, mesh.materials);
  EXPECT_EQ(back.textures, mesh.textures);
  EXPECT_EQ(back.wedges.uv, mesh.wedges.uv);
  // After others in a scene, its textures have other numbers.
  RawMesh both = read({{"normalTexture", {{"index", 6}}}});
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
      read({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
            {"extensions", {{"KHR_materials_x", {{"xTexture", {{"index", 4}, {"extensions", inner}}}}}}}});
  const Material& m = mesh.materials.at(0);
  ASSERT_EQ(m.extension_textures.size(), 2u);
  const RawMesh back = written_and_read(mesh);
  ASSERT_EQ(back.materials, mesh.materials);
  for (const std::uint32_t texture : m.extension_textures)
    EXPECT_EQ(back.textures.at(texture), mesh.textures.at(texture));
}

TEST(GltfMaterials, DeclareTheirExtensions) {
  const std::vector<std::byte> bytes = encode_glb(view_of(read(rich_material())));
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const char* name : {"unlit", "ior", "clearcoat"})
    EXPECT_NE(text.find(R"(KHR_materials_)" + std::string(name) + '"'), std::string::npos) << name;
  EXPECT_NE(text.find(R"("extensionsUsed":["KHR_)"), std::string::npos);
  EXPECT_EQ(text.find("extensionsRequired"), std::string::npos);
}

TEST(GltfMaterials, DefaultsAreThoseOfGltfAndNoMaterialIsNoMetal) {
  const RawMesh metal = read({{"name", "metal"}});
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
    const RawMesh mesh = read({{"name", "m"}, {"alphaMode", mode == AlphaMode::blend ? "BLEND" : "OPAQUE"}});
    EXPECT_EQ(mesh.materials.at(0).alpha_mode, mode);
    EXPECT_EQ(written_and_read(mesh).materials, mesh.materials);
  }
}

// (u, v) where a texture is looked up, by the letter of the extension.
std::array<double, 2> looked_up(const UvTransform& t, std::array<double, 2> uv) {
  const double c = std::cos(t.rotation), s = std::sin(t.rotation), u = uv[0] * t.scale[0], v = uv[1] * t.scale[1];
  return {c * u + s * v + t.offset[0], -s * u + c * v + t.offset[1]};
}

TEST(GltfMaterials, TexturesLieWhereTheirTransformsPutThem) {
  const json turned{{"offset", {0.25, 0.5}}, {"rotation", 0.75}, {"scale", {2, 2}}};
  const json other{{"offset", {0.125, -0.5}}, {"rotation", -0.25}, {"scale", {4, -4}}};
  const RawMesh mesh = read({{"pbrMetallicRoughness", {{"baseColorTexture", placed(0, turned)}}},
                             {"emissiveTexture", placed(1, other)},
                             {"occlusionTexture", placed(2, turned)},
                             {"normalTexture", {{"index", 3}}}});
  EXPECT_TRUE(mesh.warnings.empty());
  const Material& m = mesh.materials.at(0);
  EXPECT_EQ(m.occlusion.transform, UvTransform{});
  const std::vector<std::array<double, 2>> original{{0, 0}, {1, 0}, {0.25, 1}};
  const UvTransform emissive{{0.125f, -0.5f}, {4, -4}, -0.25f}, none;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::array<double, 2> stored{mesh.wedges.uv[k].x, mesh.wedges.uv[k].y};
    const auto expect = [&](const UvTransform& relative, const UvTransform& whole) {
      const auto found = looked_up(relative, stored), right = looked_up(whole, original[k]);
      EXPECT_NEAR(found[0], right[0], 1e-5);
      EXPECT_NEAR(found[1], right[1], 1e-5);
    };
    expect(m.emissive_map.transform, emissive);
    expect(m.normal_transform, none);
  }
}

// A grey image that grows lighter to the right, in place of texture 1.
GltfFile file_with_image(const json& material) {
  GltfFile file = file_with(material);
  PixelImage image{.size = {64, 64}, .channels = 3, .pixels = {}};
  for (std::size_t k = 0; k < 64 * 64 * 3; ++k) image.pixels.push_back(static_cast<std::uint8_t>(4 * (k / 3 % 64)));
  const std::vector<char> bytes = encode_image(image, "image/png");
  file.json["images"][1]["bufferView"] = file.view({bytes.begin(), bytes.end()});
  return file;
}

// The byte of an image at (u, v).
int shown(const RawMesh& mesh, const PlacedTexture& map, std::array<double, 2> uv) {
  const PixelImage image = decode_image(mesh.textures.at(map.texture).bytes, "image/png");
  const auto [u, v] = looked_up(map.transform, uv);
  const auto texel = [](double t, std::uint32_t n) { return std::min(static_cast<std::uint32_t>(t * n), n - 1); };
  return image.pixels[std::size_t{3} * (texel(v, image.size.height) * image.size.width + texel(u, image.size.width))];
}

// (0, 0), (1, 0), (0.25, 1) of the first set are (0, 0), (0, 1), (1, 0) of the second: the map is skewed. With (0, 1),
// (0, 0), (1, 0.75) instead it is turned.
TEST(GltfMaterials, MapsOnAnotherSetAreFoundOnTheFirst) {
  for (const bool skewed : {false, true}) {
    GltfFile file =
        file_with_image({{"normalTexture", {{"index", 0}}}, {"occlusionTexture", {{"index", 1}, {"texCoord", 1}}}});
    if (!skewed)
      file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = file.floats({0, 1, 0, 0, 1, 0.75f}, "VEC2");
    const RawMesh mesh = read_bytes(file.glb(), gltf);
    const PlacedTexture& map = mesh.materials.at(0).occlusion;
    ASSERT_NE(map.texture, no_texture);
    EXPECT_EQ(mesh.textures.size(), 2u) << "none that is in no use";
    for (const auto& [b, c] : {std::array{0.2, 0.2}, std::array{0.6, 0.2}, std::array{0.25, 0.5}})
      EXPECT_NEAR(shown(mesh, map, {b + 0.25 * c, c}), 4 * 64 * c, 8) << skewed;
    if (skewed)
      expect_warning(mesh, {"file: 1 textures are drawn anew"});
    else
      EXPECT_TRUE(mesh.warnings.empty());
  }
}

TEST(GltfMaterials, TexturesThatTheMeshHasNoCoordinatesForAreLeftOut) {
  const auto sheen = [](const json& info) { return json{{"KHR_materials_sheen", {{"sheenColorTexture", info}}}}; };
  const RawMesh sets = read({{"normalTexture", {{"index", 0}}},
                             {"emissiveTexture", placed(1, {{"texCoord", 7}})},
                             {"extensions", sheen(placed(2, {{"texCoord", 1}}))}});
  EXPECT_EQ(sets.materials.at(0).emissive_map, PlacedTexture{}) << "no primitive has that set";
  EXPECT_EQ(sets.textures.size(), 1u);
  expect_warning(sets, {"file: 2 textures are left out: they use other texture coordinates"});
  const RawMesh back = written_and_read(sets);
  EXPECT_TRUE(back.materials.at(0).extension_textures.empty());
  const RawMesh skewed =
      read({{"normalTexture", placed(0, {{"rotation", 0.5}, {"scale", {1, 2}}})}, {"emissiveTexture", {{"index", 1}}}});
  EXPECT_EQ(skewed.materials.at(0).emissive_map, PlacedTexture{}) << "cannot be decoded";
  expect_warning(skewed, {"1 textures are left out"});
  const RawMesh beyond = read({{"normalTexture", placed(0, {{"scale", {1e-30, 1e-30}}})},
                               {"emissiveTexture", placed(1, {{"scale", {1e30, 1e30}}})}});
  EXPECT_EQ(beyond.materials.at(0).emissive_map, PlacedTexture{}) << "a scale of 1e60";
  const RawMesh only = read({{"emissiveTexture", {{"index", 1}, {"texCoord", 1}}}});
  EXPECT_EQ(only.wedges.uv.at(1), (Vec2f{0, 1})) << "the coordinates of the first texture";
}

TEST(GltfMaterials, SkewedMapsAreDrawnAnew) {
  const RawMesh mesh =
      read_bytes(file_with_image({{"normalTexture", placed(0, {{"rotation", 0.5}, {"scale", {0.5, 0.8}}})},
                                  {"emissiveTexture", {{"index", 1}}}})
                     .glb(),
                 gltf);
  expect_warning(mesh, {"1 textures are drawn anew"});
  const Vec2f a = mesh.wedges.uv.at(0), b = mesh.wedges.uv.at(1), c = mesh.wedges.uv.at(2);
  const auto inside = [&](double r, double s) {
    const double q = 1 - r - s;
    const auto wrap = [](double t) { return t - std::floor(t); };
    return std::array{wrap(q * a.x + r * b.x + s * c.x), wrap(q * a.y + r * b.y + s * c.y)};
  };
  for (const auto& [r, s] : {std::array{0.2, 0.2}, std::array{0.6, 0.2}, std::array{0.3, 0.5}})
    EXPECT_NEAR(shown(mesh, mesh.materials.at(0).emissive_map, inside(r, s)), 4 * 64 * (r + 0.25 * s), 10);
}

TEST(GltfMaterials, OtherFeaturesAreNamed) {
  GltfFile file = file_with({{"extensions", {{"EXT_other", json::object()}}}});
  file.json["animations"] = {json::object()};
  file.json["cameras"] = {json::object(), json::object()};
  file.json["extensions"] = {{"KHR_lights_punctual", {{"lights", {json::object()}}}},
                             {"KHR_materials_variants", {{"variants", {{{"name", "a"}}}}}}};
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

TEST(GltfInstances, AreExpanded) {
  GltfFile file = triangle_file();
  json& node = file.json["nodes"][0];
  node["translation"] = {10, 0, 0};
  const double half = std::sqrt(0.5);
  const std::size_t move = file.floats({0, 0, 0, 0, 5, 0}, "VEC3");
  const std::size_t turn = file.floats({0, 0, 0, 1, 0, 0, static_cast<float>(half), static_cast<float>(half)}, "VEC4");
  const std::size_t scale = file.floats({1, 1, 1, 2, 2, -2}, "VEC3");
  json& attributes = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes = {{"TRANSLATION", move}, {"ROTATION", turn}, {"SCALE", scale}};
  file.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const RawMesh mesh = read_bytes(file.glb(), gltf);
  ASSERT_EQ(mesh.positions.size(), 6u);
  const std::vector<Vec3d> expected{{10, 0, 0}, {11, 0, 0}, {10, 1, 0}, {10, 5, 0}, {10, 7, 0}, {8, 5, 0}};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(length(mesh.positions[i] - expected[i]), 1e-6) << i;
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{{0, 1, 2}}, {{3, 5, 4}}})) << "the second is mirrored";
  attributes["SCALE"] = file.floats({1, 1, 1}, "VEC3");
  expect_error<InputError>(file.glb(), gltf, {"file: nodes[0]", "SCALE", "does not match the other attributes"});
  attributes = json::object();
  expect_error<InputError>(file.glb(), gltf, {"no triangle"});
}

TEST(TextureLevels, RoughnessIsAveragedAsItIs) {
  Hierarchy h;
  PixelImage image{.size = {64, 64}, .channels = 3, .pixels = {}};
  for (std::size_t k = 0; k < 64 * 64 * 3; ++k) image.pixels.push_back(static_cast<std::uint8_t>(k * k >> 3));
  h.textures = {{.name = "t", .media_type = "image/png", .bytes = encode_image(image, "image/png")}};
  h.materials = {{.name = "m"}};
  const auto copy = [&] { return decode_image(make_texture_copies(h, 0, 1).at(0).bytes, "image/png"); };
  const auto expected = [&](PixelMeaning meaning) { return to_pixels(halve(image, meaning), meaning); };
  EXPECT_EQ(copy(), expected(PixelMeaning::colours)) << "a texture of no material";
  for (PlacedTexture Material::*use : {&Material::metallic_roughness, &Material::occlusion}) {
    h.materials = {{.name = "m"}};
    (h.materials[0].*use).texture = 0;
    EXPECT_EQ(copy(), expected(PixelMeaning::values));
  }
  h.materials[0].emissive_map.texture = 0;
  EXPECT_EQ(copy(), expected(PixelMeaning::colours));
}

TEST(LodeMaterials, AreKept) {
  Hierarchy h;
  const RawMesh mesh = read(rich_material());
  h.materials = mesh.materials, h.textures = mesh.textures;
  Hierarchy to;
  ASSERT_TRUE(has_surfaces(h));
  const std::vector<std::byte> bytes = encode_assets(h);
  EXPECT_EQ(decode_assets(bytes, lode_surfaces, to), nullptr);
  EXPECT_EQ(to.materials, h.materials);
  EXPECT_EQ(to.textures, h.textures);
  EXPECT_NE(decode_assets(bytes, 0, to), nullptr);
  for (std::size_t k = bytes.size() - 600; k < bytes.size(); k += 7) {
    std::vector<std::byte> damaged = bytes;
    damaged[k] = std::byte{'!'};
    to = {};
    if (const char* fault = decode_assets(damaged, lode_surfaces, to)) {
      EXPECT_EQ(std::string_view(fault), "the surfaces are invalid");
    }
  }
}

// Surfaces that are whole JSON, but not what the records before them need.
TEST(LodeMaterials, ForeignSurfacesAreRefused) {
  Hierarchy h;
  h.materials = {{.name = "m", .metallic = 1}};
  const std::vector<std::byte> records = [&] {
    Hierarchy plain = h;
    plain.materials[0].metallic = 0;
    return encode_assets(plain);
  }();
  const auto fault_of = [&](const std::string& surfaces) {
    std::vector<std::byte> bytes = records;
    const std::uint64_t size = surfaces.size();
    for (const auto part : {std::as_bytes(std::span(&size, 1)), std::as_bytes(std::span(surfaces))})
      bytes.insert(bytes.end(), part.begin(), part.end());
    Hierarchy to;
    const char* fault = decode_assets(bytes, lode_surfaces, to);
    return std::string(fault ? fault : "");
  };
  EXPECT_EQ(fault_of(R"({"materials":[{}],"samplers":[]})"), "");
  const std::string open(100'000, '['), close(100'000, ']');
  for (const std::string& surfaces :
       {std::string("[]"), std::string(R"({"materials":[],"samplers":[]})"),
        std::string(R"({"materials":[{}],"samplers":[{"magFilter":0,"minFilter":0}]})"),
        std::string(R"({"materials":[{"normalTexture":{"index":0}}],"samplers":[]})"), open,
        R"({"materials":[{"extensions":{"KHR_materials_x":{"a":)" + open + close + R"(}}}],"samplers":[]})"})
    EXPECT_EQ(fault_of(surfaces), "the surfaces are invalid") << surfaces.substr(0, 80);
}

// Files without such materials are those of before, which older programs read.
TEST(LodeMaterials, PlainOnesNeedNoFeature) {
  Hierarchy h;
  h.materials = {{"plain", {1, 0.5f, 0.25f, 1}, 0, no_texture}};
  h.textures = {{"t", "image/png", TextureWrap::clamp, TextureWrap::mirror, {'p'}}};
  EXPECT_FALSE(has_surfaces(h));
  Hierarchy to;
  EXPECT_EQ(decode_assets(encode_assets(h), 0, to), nullptr);
  EXPECT_EQ(to.materials, h.materials);
  EXPECT_NE(decode_assets(encode_assets(h), lode_surfaces, to), nullptr);
  h.textures[0].min_filter = 9987;
  EXPECT_TRUE(has_surfaces(h));
}

}  // namespace
}  // namespace lodestone
