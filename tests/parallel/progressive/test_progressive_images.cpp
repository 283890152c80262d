// Images in files of progressive meshes: small copies of them come before the splits, they themselves after.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "core/base/error.h"
#include "core/progressive/gltf/progressive_glb.h"
#include "core/progressive/lpm/lpm_format.h"
#include "core/progressive/mesh/thumbnails.h"
#include "core/progressive/progressive_file.h"
#include "core/texture/downsample.h"
#include "core/texture/image_codec.h"
#include "parallel/scheduler/runner.h"
#include "tests/expect_error.h"
#include "tests/parallel/progressive/progressive_meshes.h"
#include "tests/test_folder.h"

namespace lodestone::test {
namespace {

// A colour picture and normals, both larger than their thumbnails, a picture that is one, and a foreign image.
ProgressiveMesh pictured_mesh() {
  ProgressiveMesh mesh = some_progressive_meshes().front();
  mesh.wedges.uv.assign(mesh.positions.size(), {});
  PixelImage image{.size = {200, 100}, .channels = 3, .pixels = {}};
  for (std::uint32_t k = 0; k < 200 * 100 * 3; ++k) image.pixels.push_back(static_cast<std::uint8_t>(k * k >> 7));
  PixelImage dot{.size = {2, 2}, .channels = 3, .pixels = std::vector<std::uint8_t>(12, 90)};
  const auto texture = [](const char* name, const char* type, std::vector<char> bytes) {
    return Texture{.name = name, .media_type = type, .bytes = std::move(bytes)};
  };
  mesh.wedges.textures = {texture("colour", "image/png", encode_image(image, "image/png")),
                          texture("normals", "image/jpeg", encode_image(image, "image/jpeg")),
                          texture("dot", "image/png", encode_image(dot, "image/png")),
                          texture("foreign", "image/ktx2", {'k', 't', 'x'}),
                          texture("unused", "image/png", encode_image(image, "image/png"))};
  mesh.wedges.materials = {{.name = "a", .texture = 0}, {.name = "b", .texture = 2}, {.name = "c", .texture = 3}};
  mesh.wedges.material.assign(mesh.positions.size(), 0);
  mesh.object_normals = {1, no_texture, no_texture};
  return mesh;
}

TEST(Thumbnails, AreSmallPicturesOfWhatIsDrawn) {
  const ProgressiveMesh mesh = pictured_mesh();
  const std::vector<Texture>&textures = mesh.wedges.textures, thumbnails = make_thumbnails(mesh);
  ASSERT_EQ(thumbnails.size(), textures.size());
  for (const std::size_t k : {0u, 1u}) {
    EXPECT_EQ(thumbnails[k].media_type, "image/webp");
    EXPECT_EQ(image_size(thumbnails[k].bytes, "image/webp"), (PixelSize{50, 25}));
    EXPECT_LT(thumbnails[k].bytes.size(), 3000u);
  }
  EXPECT_EQ(thumbnails[2], textures[2]);
  EXPECT_TRUE(thumbnails[3].bytes.empty() && thumbnails[4].bytes.empty());
  // The mean of the picture remains.
  const auto mean = [](const Texture& t) {
    const LinearImage image = to_linear(decode_image(t.bytes, t.media_type), PixelMeaning::colours);
    double sum = 0;
    for (const float x : image.values) sum += x;
    return sum / static_cast<double>(image.values.size());
  };
  EXPECT_NEAR(mean(thumbnails[0]), mean(textures[0]), 0.02);
}

TEST(Thumbnails, AreTheSameSideBySide) {
  const ProgressiveMesh mesh = pictured_mesh();
  const auto scheduler = make_tbb_scheduler(3);
  Runner runner = runner_over(*scheduler);
  std::atomic<std::size_t> items = 0;
  runner.run = [&items, run = runner.run](std::size_t count, const Runner::Body& body) {
    run(count, [&](std::size_t item, std::size_t worker) { body(count - 1 - item, worker), ++items; });
  };
  EXPECT_EQ(make_thumbnails(mesh, runner), make_thumbnails(mesh));
  EXPECT_EQ(items, mesh.wedges.textures.size());
}

TEST(Lpm, ThumbnailsStandInForImagesThatHaveNotCome) {
  const ProgressiveMesh mesh = pictured_mesh();
  const std::vector<Texture>&textures = mesh.wedges.textures, thumbnails = make_thumbnails(mesh);
  const LpmBytes lpm = encode_lpm(mesh, {}, thumbnails), plain = encode_lpm(mesh);
  const auto texture_of = [](std::span<const std::byte> bytes, bool prefix, std::size_t k) {
    ByteReader input = reader_of(bytes);
    return read_lpm(input, prefix).wedges.textures[k];
  };
  EXPECT_NEAR(static_cast<double>(lpm.geometry), static_cast<double>(plain.geometry), 200);  // the header is longer
  for (std::size_t k = 0; k < textures.size(); ++k) {
    EXPECT_EQ(texture_of(lpm.bytes, false, k), textures[k]);
    EXPECT_EQ(texture_of(plain.bytes, false, k), textures[k]);
    const Texture early = texture_of(std::span(lpm.bytes).first(lpm.base), true, k);
    EXPECT_EQ(early.bytes, thumbnails[k].bytes);
    EXPECT_EQ(early.media_type, thumbnails[k].bytes.empty() ? textures[k].media_type : thumbnails[k].media_type);
    EXPECT_EQ(early.name, textures[k].name);
  }
  ByteReader cut = reader_of(std::span(lpm.bytes).first(lpm.base - 2000));
  expect_error_of<InputError>([&] { return read_lpm(cut, true); }, {"ends early"});
}

TEST(ProgressiveGlb, ImagesComeAfterTheirThumbnails) {
  const ProgressiveMesh mesh = pictured_mesh();
  const std::vector<Texture> thumbnails = make_thumbnails(mesh);
  for (const bool compressed : {false, true}) {
    const std::vector<std::byte> bytes = encode_progressive_glb(mesh, compressed, thumbnails);
    ByteReader input = reader_of(bytes);
    const std::vector<Texture> back = read_progressive(input).wedges.textures;  // of the material that is used
    ASSERT_EQ(back.size(), 2u);
    EXPECT_TRUE(std::equal(back.begin(), back.end(), mesh.wedges.textures.begin()));
    const TestFolder folder;
    const ProgressiveFileSize size = save_progressive(mesh, folder / "a.glb", {.lpm = {}, .compress_glb = compressed});
    EXPECT_EQ(size.bytes, bytes.size());
    const auto at = [&](const Texture& t, std::size_t from) {
      const std::span<const std::byte> image = std::as_bytes(std::span(t.bytes));
      return std::search(bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.end(), image.begin(), image.end());
    };
    for (const std::size_t k : {0u, 1u}) {
      EXPECT_NE(at(mesh.wedges.textures[k], size.base), bytes.end());
      EXPECT_LT(at(thumbnails[k], 0), bytes.begin() + static_cast<std::ptrdiff_t>(size.base));
    }
  }
}

}  // namespace
}  // namespace lodestone::test
