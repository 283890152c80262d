// Textures of glTF on other coordinates than the first ones of the mesh: placed, found again, drawn anew or left out.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/texture/image_codec.h"
#include "tests/core/formats/gltf_material_file.h"

namespace lodestone {
namespace {

using nlohmann::json;
constexpr auto gltf = MeshFormat::gltf;

// (u, v) where a texture is looked up, by the letter of the extension.
std::array<double, 2> looked_up(const UvTransform& t, std::array<double, 2> uv) {
  const double c = std::cos(t.rotation), s = std::sin(t.rotation), u = uv[0] * t.scale[0], v = uv[1] * t.scale[1];
  return {c * u + s * v + t.offset[0], -s * u + c * v + t.offset[1]};
}

TEST(GltfMaterials, TexturesLieWhereTheirTransformsPutThem) {
  const json turned{{"offset", {0.25, 0.5}}, {"rotation", 0.75}, {"scale", {2, 2}}};
  const json other{{"offset", {0.125, -0.5}}, {"rotation", -0.25}, {"scale", {4, -4}}};
  const RawMesh mesh = read_material({{"pbrMetallicRoughness", {{"baseColorTexture", placed(0, turned)}}},
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
  const RawMesh sets = read_material({{"normalTexture", {{"index", 0}}},
                                      {"emissiveTexture", placed(1, {{"texCoord", 7}})},
                                      {"extensions", sheen(placed(2, {{"texCoord", 1}}))}});
  EXPECT_EQ(sets.materials.at(0).emissive_map, PlacedTexture{}) << "no primitive has that set";
  EXPECT_EQ(sets.textures.size(), 1u);
  expect_warning(sets, {"file: 2 textures are left out: they use other texture coordinates"});
  const RawMesh back = written_and_read(sets);
  EXPECT_TRUE(back.materials.at(0).extension_textures.empty());
  const RawMesh skewed = read_material(
      {{"normalTexture", placed(0, {{"rotation", 0.5}, {"scale", {1, 2}}})}, {"emissiveTexture", {{"index", 1}}}});
  EXPECT_EQ(skewed.materials.at(0).emissive_map, PlacedTexture{}) << "cannot be decoded";
  expect_warning(skewed, {"1 textures are left out"});
  const RawMesh beyond = read_material({{"normalTexture", placed(0, {{"scale", {1e-30, 1e-30}}})},
                                        {"emissiveTexture", placed(1, {{"scale", {1e30, 1e30}}})}});
  EXPECT_EQ(beyond.materials.at(0).emissive_map, PlacedTexture{}) << "a scale of 1e60";
  const RawMesh only = read_material({{"emissiveTexture", {{"index", 1}, {"texCoord", 1}}}});
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

}  // namespace
}  // namespace lodestone
