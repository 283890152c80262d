// Materials and textures in .lode files: kept as they are, or refused.
#include <gtest/gtest.h>

#include "core/hierarchy/lode/lode_format.h"
#include "tests/core/formats/gltf_material_file.h"

namespace lodestone {
namespace {

TEST(LodeMaterials, AreKept) {
  Hierarchy h;
  const RawMesh mesh = read_material(rich_material());
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
