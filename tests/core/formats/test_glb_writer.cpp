// Binary glTF by the letter of its specification: chunks, alignment, accessors, and what they hold.
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "core/formats/gltf/gltf.h"

namespace lodestone {
namespace {

using nlohmann::json;

struct Glb {
  json root;
  std::vector<std::byte> binary;

  template <class T>
  [[nodiscard]] std::vector<T> values(std::size_t accessor) const {
    const json& a = root["accessors"][accessor];
    const json& view = root["bufferViews"][a["bufferView"].get<std::size_t>()];
    std::vector<T> out(view["byteLength"].get<std::size_t>() / sizeof(T));
    std::memcpy(out.data(), binary.data() + view["byteOffset"].get<std::size_t>(), out.size() * sizeof(T));
    return out;
  }
};

std::uint32_t word(const std::vector<std::byte>& bytes, std::size_t at) {
  std::uint32_t v = 0;
  std::memcpy(&v, bytes.data() + at, 4);
  return v;
}

Glb parse(const std::vector<std::byte>& bytes) {
  EXPECT_EQ(word(bytes, 0), 0x46546c67u);
  EXPECT_EQ(word(bytes, 4), 2u);
  EXPECT_EQ(word(bytes, 8), bytes.size());
  const std::size_t text = word(bytes, 12);
  EXPECT_EQ(word(bytes, 16), 0x4e4f534au);
  EXPECT_EQ(text % 4, 0u);
  EXPECT_EQ(word(bytes, 20 + text), bytes.size() - 28 - text);
  EXPECT_EQ(word(bytes, 24 + text), 0x004e4942u);
  const char* begin = reinterpret_cast<const char*>(bytes.data()) + 20;
  Glb glb{json::parse(begin, begin + text), {bytes.begin() + static_cast<std::ptrdiff_t>(28 + text), bytes.end()}};
  EXPECT_EQ(glb.root["buffers"][0]["byteLength"], glb.binary.size());
  for (const json& view : glb.root["bufferViews"]) {
    EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
    EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(), glb.binary.size());
  }
  return glb;
}

RawMesh far_square() {
  RawMesh mesh;
  mesh.up = {UpAxis::y, false};
  mesh.positions = {{1e7, 0, 5}, {1e7 + 1, 0, 5}, {1e7 + 1, 1, 5}, {1e7, 1, 5}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  return mesh;
}

TEST(GlbWriter, FarFromTheOriginLosesNothing) {
  const RawMesh mesh = far_square();
  const Glb glb = parse(encode_glb(view_of(mesh)));
  EXPECT_EQ(glb.root["nodes"][0]["translation"], json({1e7 + 0.5, 0.5, 5.0}));
  EXPECT_EQ(glb.values<Vec3f>(0),
            (std::vector<Vec3f>{{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}}));
  EXPECT_EQ(glb.root["accessors"][0]["min"], json({-0.5, -0.5, 0.0}));
  EXPECT_EQ(glb.root["accessors"][0]["max"], json({0.5, 0.5, 0.0}));
  const json& primitive = glb.root["meshes"][0]["primitives"][0];
  EXPECT_EQ(glb.values<std::uint32_t>(primitive["indices"]), (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(glb.root["materials"].size(), 1u);
  EXPECT_EQ(glb.root["materials"][0]["pbrMetallicRoughness"]["metallicFactor"], 0);
  EXPECT_EQ(primitive["material"], 0);
}

TEST(GlbWriter, CarriesAttributesMaterialsAndTextures) {
  RawMesh mesh = far_square();
  mesh.wedges.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.wedges.normal.assign(4, {0, 0, 1});
  mesh.wedges.colour.assign(4, {255, 0, 188, 51});
  mesh.wedges.material = {1, 0};
  mesh.materials = {{"plain", {1, 0.5f, 0, 1}, no_texture, no_texture}, {"stone", {1, 1, 1, 1}, 1, 0}};
  mesh.textures = {{"bumps", "image/webp", TextureWrap::repeat, TextureWrap::repeat, {'w', 'e'}},
                   {"stone", "image/png", TextureWrap::clamp, TextureWrap::mirror, {'p', 'n', 'g'}}};
  const Glb glb = parse(encode_glb(view_of(mesh)));
  const json& primitives = glb.root["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), 2u);
  EXPECT_EQ(primitives[0]["material"], 0);
  EXPECT_EQ(glb.values<std::uint32_t>(primitives[0]["indices"]), (std::vector<std::uint32_t>{0, 2, 3}));
  EXPECT_EQ(glb.values<Vec2f>(primitives[0]["attributes"]["TEXCOORD_0"]), mesh.wedges.uv);
  EXPECT_EQ(glb.values<Vec3f>(primitives[0]["attributes"]["NORMAL"]), mesh.wedges.normal);
  const auto colours = glb.values<std::array<float, 4>>(primitives[0]["attributes"]["COLOR_0"]);
  EXPECT_FLOAT_EQ(colours[0][0], 1);
  EXPECT_NEAR(colours[0][2], 0.503f, 0.001f);  // sRGB 188 is half of the light
  EXPECT_FLOAT_EQ(colours[0][3], 0.2f);
  EXPECT_EQ(glb.root["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 1);
  EXPECT_EQ(glb.root["materials"][1]["normalTexture"]["index"], 0);
  EXPECT_EQ(glb.root["samplers"][1], json({{"wrapS", 33071}, {"wrapT", 33648}}));
  EXPECT_EQ(glb.root["textures"][0]["extensions"]["EXT_texture_webp"]["source"], 0);
  EXPECT_EQ(glb.root["extensionsRequired"], json({"EXT_texture_webp"}));
  EXPECT_EQ(glb.root["images"][1]["mimeType"], "image/png");
}

}  // namespace
}  // namespace lodestone
