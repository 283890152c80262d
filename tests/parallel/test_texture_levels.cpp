// Copies of textures from the build to the file, the verifier and the tiles.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "core/base/error.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/verify/verify.h"
#include "core/mesh/generate.h"
#include "core/texture/downsample.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save.h"
#include "parallel/hierarchy/texture_levels.h"
#include "tests/core/formats/io_test_util.h"

namespace lodestone {
namespace {

std::vector<char> image(std::uint32_t side, std::uint32_t channels, const std::string& type) {
  PixelImage pixels{.size = {side, side}, .channels = channels, .pixels = {}};
  for (std::uint32_t i = 0; i < side * side; ++i)
    for (std::uint32_t c = 0; c < channels; ++c)
      pixels.pixels.push_back(static_cast<std::uint8_t>((i % side * (c + 1) + i / side * 3) % 256));
  return encode_image(pixels, type);
}

// Terrain with texture coordinates, two materials and five textures, two of which cannot be halved.
Hierarchy textured(Scheduler& scheduler, bool half_levels = false) {
  RawMesh raw = generate_mesh({Shape::terrain, 4000, 3});
  for (const Vec3d p : raw.positions) raw.wedges.uv.push_back({static_cast<float>(p.x), static_cast<float>(p.y)});
  for (std::size_t t = 0; t < raw.triangles.size(); ++t) raw.wedges.material.push_back(t % 2);
  raw.textures = {{.name = "photo", .media_type = "image/jpeg", .bytes = image(200, 3, "image/jpeg")},
                  {.name = "broken", .media_type = "image/png", .bytes = {'x'}},
                  {.name = "bumps", .media_type = "image/png", .bytes = image(128, 3, "image/png")},
                  {.name = "web", .media_type = "image/ktx2", .bytes = {'R'}},
                  {.name = "grey", .media_type = "image/png", .bytes = image(512, 1, "image/png")}};
  raw.materials = {{.name = "a", .texture = 0, .normal_map = 2}, {.name = "b", .texture = 4, .normal_map = 1}};
  Repairs repairs;
  BuildConfig config;
  config.half_levels = half_levels;
  config.finest_level = half_levels ? 4 : 2;
  return build_hierarchy(prepare_mesh(std::move(raw), repairs, scheduler), config, scheduler);
}

const VerifyCheck& texture_check(const VerifyReport& report) {
  static const VerifyCheck none{"none", false, "there is no check of textures"};
  const VerifyCheck* check = report.find("textures");
  return check ? *check : none;
}

TEST(TextureLevels, AreTheSameForAnyNumberOfThreadsAndSurviveTheFile) {
  const auto serial = make_serial_scheduler();
  Hierarchy h = textured(*serial);
  const std::vector<std::string> warnings = add_texture_copies(h, *serial);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("'broken' is not a valid PNG"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("'web' is of type image/ktx2"), std::string::npos) << warnings[1];
  std::vector<std::array<std::uint32_t, 3>> sizes;
  for (const TextureCopy& c : h.texture_copies) sizes.push_back({c.texture, c.halvings, c.width});
  EXPECT_EQ(sizes, (std::vector<std::array<std::uint32_t, 3>>{
                       {0, 1, 100}, {0, 2, 50}, {2, 1, 64}, {2, 2, 32}, {4, 1, 256}, {4, 2, 128}}));
  for (const int threads : {1, 2, 3, 7}) {
    const auto scheduler = make_tbb_scheduler(threads);
    Hierarchy other = h;
    EXPECT_EQ(add_texture_copies(other, *scheduler), warnings);
    EXPECT_EQ(other.texture_copies, h.texture_copies) << threads;
  }
  const TestFolder folder;
  const std::filesystem::path path = folder.path() / "m.lode";
  save_lode(h, path, *serial);
  const Hierarchy read = load_lode(path, *serial);
  EXPECT_EQ(read.texture_copies, h.texture_copies);
  EXPECT_EQ(read.textures, h.textures);
  EXPECT_EQ(level_mesh(read, 0).textures[4].bytes, h.texture_copies[5].bytes);
  EXPECT_EQ(level_mesh(read, 2).textures, h.textures);
  EXPECT_TRUE(verify_hierarchy(read).valid());
}

// Texels follow the triangles: two half levels halve the sides of a texture once.
TEST(TextureLevels, HalfLevelsShareCopies) {
  const auto scheduler = make_serial_scheduler();
  Hierarchy h = textured(*scheduler, true), quarters = textured(*scheduler);
  (void)add_texture_copies(h, *scheduler), (void)add_texture_copies(quarters, *scheduler);
  EXPECT_EQ(h.texture_copies, quarters.texture_copies);
  EXPECT_EQ(texture_copy(h, 0, 3), nullptr);
  EXPECT_EQ(texture_copy(h, 0, 2)->halvings, 1u);
  EXPECT_EQ(texture_copy(h, 0, 1)->halvings, 1u);
  EXPECT_EQ(texture_copy(h, 0, 0)->halvings, 2u);
  EXPECT_TRUE(verify_hierarchy(h).valid());
}

TEST(TextureLevels, VerifySeesEachFault) {
  const auto scheduler = make_tbb_scheduler(2);
  Hierarchy h = textured(*scheduler);
  EXPECT_EQ(verify_hierarchy(h).find("textures"), nullptr);
  (void)add_texture_copies(h, *scheduler);
  EXPECT_TRUE(texture_check(verify_hierarchy(h)).passed) << texture_check(verify_hierarchy(h)).detail;
  const auto fault = [&](const auto& change) {
    Hierarchy other = h;
    change(other.texture_copies);
    const VerifyCheck check = texture_check(verify_hierarchy(other));
    EXPECT_FALSE(check.passed);
    return check.detail;
  };
  using Copies = std::vector<TextureCopy>;
  const auto pixels = [](std::uint32_t side, std::uint8_t byte) {
    PixelImage image{.size = {side, side}, .channels = 3, .pixels = {}};
    image.pixels.assign(std::size_t{side} * side * 3, byte);
    return encode_image(image, "image/png");
  };
  EXPECT_NE(fault([](Copies& c) { c[0].width = 99; }).find("half the size"), std::string::npos);
  EXPECT_NE(fault([&](Copies& c) { c[2].bytes = pixels(65, 100); }).find("half the size"), std::string::npos);
  EXPECT_NE(fault([&](Copies& c) { c[4].bytes = pixels(256, 90); }).find("mean"), std::string::npos);
  EXPECT_NE(fault([](Copies& c) { c[3].bytes.resize(50); }).find("PNG"), std::string::npos);
}

TEST(TextureLevels, StopWhenTheyAreToldTo) {
  const auto scheduler = make_tbb_scheduler(2);
  Hierarchy h = textured(*scheduler);
  const CancelFlag cancel{true};
  EXPECT_THROW((void)add_texture_copies(h, *scheduler, &cancel), Cancelled);
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

}  // namespace
}  // namespace lodestone
