// Levels of textures, what models share of them and what becomes of those that cannot be shown.
#include <gtest/gtest.h>

#include <random>

#include "core/texture/normal_space.h"
#include "core/texture/page_packer.h"
#include "core/texture/texel_wrap.h"
#include "render/frame/appearance.h"
#include "render/textures/surface_textures.h"
#include "tests/render/planar_model.h"

namespace lodestone {
namespace {

using namespace lodestone::test;
using enum TextureWrap;

std::uint8_t channel(std::uint32_t texel, int c) { return static_cast<std::uint8_t>(texel >> (8 * c)); }

TEST(MipChain, LevelsAreMeansOfLight) {
  std::mt19937 random(1);
  PixelImage image{.size = {8, 4}, .channels = 3, .pixels = {}};
  for (int i = 0; i < 8 * 4 * 3; ++i) image.pixels.push_back(static_cast<std::uint8_t>(random()));
  const std::vector<MipLevel> levels = make_mip_chain(image, PixelMeaning::colours, repeat, repeat);
  ASSERT_EQ(levels.size(), 4u);
  const auto light = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  const auto encoded = [](double l) { return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055; };
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const std::uint32_t side_x = 8u >> l, side_y = std::max(4u >> l, 1u);
    ASSERT_EQ(levels[l].size, (PixelSize{side_x, side_y}));
    for (std::uint32_t y = 0; y < side_y; ++y)
      for (std::uint32_t x = 0; x < side_x; ++x)
        for (int c = 0; c < 3; ++c) {
          double sum = 0;
          const std::uint32_t w = 8 / side_x, h = 4 / side_y;
          for (std::uint32_t j = y * h; j < (y + 1) * h; ++j)
            for (std::uint32_t i = x * w; i < (x + 1) * w; ++i)
              sum += light(image.pixels[3 * (j * 8 + i) + static_cast<std::size_t>(c)] / 255.0);
          const double mean = 255 * encoded(sum / (w * h));
          EXPECT_NEAR(channel(levels[l].texels[(y + 1) * levels[l].stride() + x + 1], c), mean, l == 0 ? 0.01 : 0.51);
        }
  }
}

TEST(MipChain, EveryImageEndsInOneTexelAndHasItsBorder) {
  for (const PixelSize size : {PixelSize{1, 1}, PixelSize{1, 7}, PixelSize{5, 3}, PixelSize{16, 16}, PixelSize{33, 2}})
    for (const std::uint32_t channels : {1u, 3u, 4u})
      for (const TextureWrap u : {repeat, clamp, mirror})
        for (const TextureWrap v : {repeat, clamp, mirror}) {
          PixelImage image{.size = size, .channels = channels, .pixels = {}};
          for (std::size_t i = 0; i < std::size_t{size.width} * size.height * channels; ++i)
            image.pixels.push_back(static_cast<std::uint8_t>(37 * i + 11));
          const std::vector<MipLevel> levels = make_mip_chain(image, PixelMeaning::colours, u, v);
          EXPECT_EQ(levels.back().size, (PixelSize{1, 1}));
          for (const MipLevel& level : levels) {
            ASSERT_EQ(level.texels.size(), std::size_t{level.stride()} * level.rows());
            const auto at = [&](std::int64_t x, std::int64_t y) {
              return level.texels[static_cast<std::size_t>((y + 1) * level.stride() + x + 1)];
            };
            for (std::int64_t y = -1; y <= level.size.height; ++y)
              for (std::int64_t x = -1; x <= level.size.width; ++x)
                ASSERT_EQ(at(x, y), at(wrapped(x, level.size.width, u), wrapped(y, level.size.height, v)));
          }
          // Alpha is left out, grey is all three.
          for (int c = 0; c < 3; ++c)
            EXPECT_EQ(channel(levels[0].texels[levels[0].stride() + 1], c),
                      image.pixels[channels == 1 ? 0 : static_cast<std::size_t>(c)]);
        }
}

TEST(Wrapped, IsWhatWalkingAlongTheImageGives) {
  for (const std::uint32_t n : {1u, 2u, 5u}) {
    for (std::int64_t i = -23; i < 23; ++i) {
      std::int64_t repeated = i, mirrored = i;
      while (repeated < 0) repeated += n;
      while (repeated >= n) repeated -= n;
      while (mirrored < 0 || mirrored >= n)
        mirrored = mirrored < 0 ? -1 - mirrored : 2 * std::int64_t{n} - 1 - mirrored;
      EXPECT_EQ(wrapped(i, n, repeat), repeated);
      EXPECT_EQ(wrapped(i, n, mirror), mirrored);
      EXPECT_EQ(wrapped(i, n, clamp), std::min<std::int64_t>(std::max<std::int64_t>(i, 0), n - 1));
    }
  }
}

TEST(NormalMaps, TellTheirSpace) {
  EXPECT_FALSE(is_object_space(painted({64, 64}, bumps)));
  EXPECT_TRUE(is_object_space(painted({64, 64}, every_direction)));
  // Texels between charts are ignored.
  EXPECT_FALSE(is_object_space(painted({64, 64}, [](float u, float v) { return u < 0.1f ? bumps(u, v) : Vec3f{}; })));
  EXPECT_FALSE(is_object_space({.size = {2, 1}, .channels = 1, .pixels = {0, 0}}));
}

class Textures : public ::testing::Test {
 protected:
  static Material material(std::uint32_t texture, std::uint32_t normal_map = no_texture) {
    return {"", {1, 1, 1, 1}, texture, normal_map};
  }
  // A frame of all models that shows all that they have.
  std::size_t prepare(EffectSet effects = EffectSet::all()) {
    Frame frame;
    frame.models.resize(models_.size());
    for (std::uint32_t m = 0; m < models_.size(); ++m) {
      frame.models[m].model = m;
      frame.models[m].morph.hierarchy = models_[m].get();
      frame.models[m].effects = effects;
    }
    return textures_.prepare(frame, *scheduler_);
  }
  void set_models(const TextureLimits& limits = {}) {
    std::vector<const Hierarchy*> all;
    for (const auto& m : models_) all.push_back(m.get());
    textures_.set_models(all, limits);
  }
  [[nodiscard]] const SurfaceTexture& texture(std::uint32_t model, std::size_t material) const {
    return textures_.textures()[textures_.materials(model)[material].texture];
  }

  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
  std::vector<std::shared_ptr<const Hierarchy>> models_;
  SurfaceTextures textures_;
};

TEST_F(Textures, AreDecodedOnceWhenFirstShown) {
  const std::vector<Texture> images{as_texture("a", painted({32, 32}, motley)),
                                    as_texture("b", painted({16, 8}, bumps))};
  models_ = {planar_model(0, {}, images, {material(0, 1), material(0), material(no_texture, 1)})};
  models_.push_back(models_[0]);
  models_.push_back(planar_model(0, {}, images, {material(1, 1)}));
  set_models();
  EXPECT_EQ(textures_.textures().size(), 4u);  // b twice in the last: as colours and as normals
  EXPECT_EQ(prepare({}), 0u);
  EXPECT_EQ(prepare({Effect::texture}), 2u);
  EXPECT_EQ(prepare({Effect::texture}), 0u);
  EXPECT_EQ(prepare(), 2u);
  EXPECT_EQ(prepare(), 0u);
  EXPECT_EQ(textures_.materials(0)[1].texture, textures_.materials(1)[2].texture);
  EXPECT_TRUE(textures_.take_warnings().empty());
}

TEST_F(Textures, FitTheirLimits) {
  const std::vector<Texture> images{as_texture("large", painted({256, 64}, motley)),
                                    as_texture("small", painted({64, 64}, motley))};
  models_ = {planar_model(0, {}, images, {material(0), material(1)})};
  set_models({.side = 128, .bytes = 1 << 20});
  prepare();
  EXPECT_EQ(texture(0, 1).levels.front().size, (PixelSize{128, 32}));
  EXPECT_EQ(texture(0, 2).levels.front().size, (PixelSize{64, 64}));
  // The reduced texture is the level that the whole one has.
  set_models();
  prepare();
  const MipLevel half = texture(0, 1).levels[1];
  set_models({.side = 128, .bytes = 1 << 20});
  prepare();
  EXPECT_EQ(texture(0, 1).levels.front().texels, half.texels);
  for (const std::uint64_t bytes : {60'000u, 20'000u, 3'000u, 1u}) {
    set_models({.side = 8192, .bytes = bytes});
    prepare();
    std::uint64_t sum = 0;
    for (const SurfaceTexture& t : textures_.textures())
      for (const MipLevel& l : t.levels) sum += 4ull * l.size.width * l.size.height;
    EXPECT_LE(sum, std::max<std::uint64_t>(bytes, 64));
  }
}

TEST_F(Textures, ReducedOnesComeFromTheirCopies) {
  auto model =
      std::make_shared<Hierarchy>(*planar_model(0, {}, {as_texture("a", painted({256, 256}, motley))}, {material(0)}));
  // A copy of another colour: it is seen where it is used.
  const Texture copy = as_texture("", painted({64, 64}, [](float, float) { return Vec3f{0, 1, 0}; }));
  model->texture_copies = {{0, 1, 128, 128, model->textures[0].bytes}, {0, 2, 64, 64, copy.bytes}};
  models_ = {model};
  set_models({.side = 32});
  prepare();
  EXPECT_EQ(texture(0, 1).levels.front().size, (PixelSize{32, 32}));
  EXPECT_EQ(texture(0, 1).levels.front().texels[100], 0xff00'ff00u);
}

TEST_F(Textures, ThoseThatCannotBeHadAreMarked) {
  Texture damaged = as_texture("damaged.png", painted({32, 32}, motley)), foreign = damaged, bumpy = damaged;
  damaged.bytes.resize(damaged.bytes.size() / 2);
  foreign.name = "foreign.ktx2", foreign.media_type = "image/ktx2", foreign.bytes.assign(20, 'x');
  bumpy.name = "bumpy.png", bumpy.bytes.resize(bumpy.bytes.size() / 2);
  models_ = {planar_model(0, {}, {damaged, foreign, bumpy}, {material(0, 2), material(1), material(0)})};
  set_models();
  EXPECT_EQ(prepare(), 3u);
  const std::vector<std::string> warnings = textures_.take_warnings();
  ASSERT_EQ(warnings.size(), 3u);
  for (const char* name : {"damaged.png", "foreign.ktx2", "bumpy.png"})
    EXPECT_TRUE(std::ranges::any_of(warnings, [&](const std::string& w) { return w.find(name) != w.npos; })) << name;
  EXPECT_EQ(prepare(), 0u);
  EXPECT_TRUE(textures_.take_warnings().empty());
  for (const std::size_t m : {1u, 2u}) EXPECT_EQ(texture(0, m).levels.front().texels[65 + 2], 0xffff'00ffu);
  EXPECT_EQ(textures_.materials(0)[1].normal_map, no_texture);
}

TEST(LookOf, WhiteForModelsWithColoursOfTheirOwn) {
  const Vec3f white{1, 1, 1};
  Hierarchy h;
  EXPECT_EQ(appearance_of(h), Appearance{});
  h.attributes.colours = true;
  EXPECT_EQ(appearance_of(h).base_colour, white);
  Appearance plain;
  plain.vertex_colours = false;
  EXPECT_EQ(appearance_of(h, plain), plain);
  h.attributes.colours = false;
  h.materials = {{"", {1, 1, 1, 1}, 0, no_texture}};
  EXPECT_EQ(appearance_of(h), Appearance{});  // nowhere to show the texture
  h.attributes.uv = true;
  EXPECT_EQ(appearance_of(h).base_colour, white);
  h.materials = {{"", {1, 1, 0.5f, 1}, no_texture, no_texture}};
  EXPECT_EQ(appearance_of(h).base_colour, white);
  plain.textures = false;
  EXPECT_EQ(appearance_of(h, plain), plain);
}

TEST(PagePacker, RectanglesLieApart) {
  std::mt19937 random(3);
  PagePacker packer({300, 200});
  std::vector<std::vector<char>> used;
  for (int i = 0; i < 400; ++i) {
    const PixelSize size{static_cast<std::uint32_t>(1 + random() % 90), static_cast<std::uint32_t>(1 + random() % 60)};
    const PagePlace at = packer.add(size);
    used.resize(packer.pages(), std::vector<char>(300 * 200, 0));
    ASSERT_LE(at.x + size.width, 300u);
    ASSERT_LE(at.y + size.height, 200u);
    for (std::uint32_t y = at.y; y < at.y + size.height; ++y)
      for (std::uint32_t x = at.x; x < at.x + size.width; ++x) ASSERT_EQ(used[at.page][y * 300 + x]++, 0);
  }
}

TEST(PagePacker, APageHoldsTheLevelsOfItsLargestTexture) {
  for (const PixelSize size : {PixelSize{1, 1}, PixelSize{64, 64}, PixelSize{4096, 4096}, PixelSize{8192, 16},
                               PixelSize{16, 8192}, PixelSize{1000, 300}}) {
    PagePacker packer(page_for(size));
    for (PixelSize level = size;; level = half_of(level)) {
      (void)packer.add({level.width + 2, level.height + 2});
      if (level == PixelSize{1, 1}) break;
    }
    EXPECT_EQ(packer.pages(), 1u) << size.width << " x " << size.height;
  }
}

}  // namespace
}  // namespace lodestone
