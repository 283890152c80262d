// Atlases of tiles show what the textures show, at every point of every triangle, and at three mip levels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/hierarchy/tiles/tile_atlas.h"
#include "core/mesh/generate.h"
#include "core/texture/colour.h"
#include "core/texture/downsample.h"
#include "core/texture/texel_wrap.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/decoded_images.h"

namespace lodestone {
namespace {

constexpr std::uint32_t strips = 8;  // of the terrain, a material each

PixelImage patterned(PixelSize size, std::uint32_t seed) {
  PixelImage image{.size = size, .channels = 3, .pixels = {}};
  for (std::uint32_t i = 0; i < size.width * size.height * 3; ++i)
    image.pixels.push_back(static_cast<std::uint8_t>((i * 2654435761u + seed * 40503u) >> 13));
  return image;
}

Texture texture_of(const PixelImage& image, TextureWrap u, TextureWrap v) {
  return {"", "image/png", u, v, encode_image(image, "image/png")};
}

Material textured_material() {
  Material material;
  material.texture = 0;
  return material;
}

// Each strip shows its texture on a range of coordinates of its own.
Hierarchy striped(const std::vector<Material>& materials, const std::vector<Texture>& textures, double repeats = 1.3) {
  RawMesh raw = generate_mesh({Shape::terrain, 3000, 3});
  const auto strip_of = [&](const Triangle& t) {
    double y = 0;
    for (const std::uint32_t v : t.v) y += raw.positions[v].y / 3;
    return std::min(static_cast<std::uint32_t>(y * strips), strips - 1);
  };
  for (const Triangle& t : raw.triangles) {
    const std::uint32_t strip = strip_of(t);
    Triangle wedges;
    for (std::size_t k = 0; k < 3; ++k) {
      wedges.v[k] = static_cast<std::uint32_t>(raw.wedges.uv.size());
      const Vec3d p = raw.positions[t.v[k]];
      raw.wedges.uv.push_back({static_cast<float>(repeats * p.x - 3.2), static_cast<float>(2.0 * p.y + strip)});
    }
    raw.wedges.corners.push_back(wedges);
    raw.wedges.material.push_back(strip % static_cast<std::uint32_t>(materials.size()));
  }
  raw.materials = materials;
  raw.textures = textures;
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  BuildConfig config;
  config.finest_level = 2;
  return build_hierarchy(prepare_mesh(std::move(raw), repairs, *scheduler), config, *scheduler);
}

// Bilinear, in double.
std::array<double, 4> sampled(const PixelImage& image, Vec2f uv, TextureWrap wrap_u, TextureWrap wrap_v) {
  const double x = uv.x * static_cast<double>(image.size.width) - 0.5,
               y = uv.y * static_cast<double>(image.size.height) - 0.5;
  const auto i = static_cast<std::int64_t>(std::floor(x)), j = static_cast<std::int64_t>(std::floor(y));
  std::array<double, 4> sum{};
  for (const int a : {0, 1})
    for (const int b : {0, 1}) {
      const double weight =
          (a ? x - std::floor(x) : 1 - x + std::floor(x)) * (b ? y - std::floor(y) : 1 - y + std::floor(y));
      const std::size_t at = std::size_t{wrapped(j + b, image.size.height, wrap_v)} * image.size.width +
                             wrapped(i + a, image.size.width, wrap_u);
      for (std::size_t c = 0; c < 4; ++c)
        sum[c] += weight * (c < image.channels ? image.pixels[at * image.channels + c] : 255);
    }
  return sum;
}

class TileAtlases : public testing::Test {
 protected:
  static TileAtlas atlas_of(const Hierarchy& h, CellId cell) {
    DecodedImages images(h, std::size_t{1} << 24);
    const int level = h.level_of(cell);
    return make_tile_atlas(h, cell, {.pixels = [&](std::uint32_t t) { return images.get(t, level); }, .morph = true});
  }

  // Calls visit(material, old coordinates, new ones) for points of all triangles that an atlas shows, where they are
  // and where their parents are.
  static void for_each_point(const Hierarchy& h, CellId number, const TileAtlas& atlas,
                             const std::function<void(std::uint32_t, Vec2f, Vec2f)>& visit) {
    const Cell& cell = h.cells[number];
    std::vector<Vec2f> parent_uv;
    for (const std::uint32_t p : cell.parents) parent_uv.push_back(h.cells[cell.parent].attributes.uv[p]);
    ASSERT_EQ(atlas.parent_uv.empty(), cell.parent == no_cell || atlas.materials.empty());
    for (const Triangle& t : cell.triangles) {
      const std::uint32_t material = cell.attributes.materials[t.v[0]];
      if (!atlas.replacing(material)) continue;
      for (const auto& weights : {std::pair{1.0f, 0.0f}, {0.0f, 1.0f}, {0.0f, 0.0f}, {0.3f, 0.3f}, {0.1f, 0.6f}}) {
        const auto mix = [&](std::span<const Vec2f> uv) {
          const auto [a, b] = weights;
          const Vec2f p = uv[t.v[0]], q = uv[t.v[1]], r = uv[t.v[2]];
          const float c = 1 - a - b;
          return Vec2f{a * p.x + b * q.x + c * r.x, a * p.y + b * q.y + c * r.y};
        };
        visit(material, mix(cell.attributes.uv), mix(atlas.uv));
        if (!atlas.parent_uv.empty()) visit(material, mix(parent_uv), mix(atlas.parent_uv));
      }
    }
  }
};

TEST_F(TileAtlases, ShowWhatTexturesShow) {
  using enum TextureWrap;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<PixelImage> images;
  for (std::uint32_t k = 0; k < strips; ++k) {
    images.push_back(patterned({32 + 4 * k, 48 - 3 * k}, k));
    textures.push_back(texture_of(images.back(),
                                  k % 3 == 0   ? repeat
                                  : k % 3 == 1 ? mirror
                                               : clamp,
                                  k % 2 ? repeat : mirror));
    materials.push_back({.name = std::to_string(k), .texture = k});
  }
  const Hierarchy h = striped(materials, textures);
  for (CellId cell(0); cell < h.cells.size(); ++cell) {
    const TileAtlas atlas = atlas_of(h, cell);
    if (h.level_of(cell) == 0) {
      ASSERT_EQ(atlas.materials.size(), 1u);
      for (std::uint32_t m = 0; m < strips; ++m) EXPECT_EQ(atlas.replacing(m), 0u);
    }
    if (atlas.materials.empty()) continue;
    const PixelImage image = decode_image(atlas.images[0].bytes, "image/png");
    std::size_t points = 0;
    for_each_point(h, cell, atlas, [&](std::uint32_t material, Vec2f before, Vec2f after) {
      const Texture& t = textures[material];
      const auto expected = sampled(images[material], before, t.wrap_u, t.wrap_v),
                 found = sampled(image, after, clamp, clamp);
      for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(found[c], expected[c], 0.6) << cell;  // floats of coordinates
      ++points;
    });
    EXPECT_GT(points, 100u);
  }
}

TEST_F(TileAtlases, PartsDoNotBleedIntoEachOtherInThreeMipLevels) {
  std::vector<Material> materials;
  std::vector<Texture> textures;
  for (std::uint32_t k = 0; k < strips; ++k) {
    PixelImage flat{.size = {64, 64}, .channels = 3, .pixels = std::vector<std::uint8_t>(64 * 64 * 3)};
    std::ranges::fill(flat.pixels, static_cast<std::uint8_t>(30 * k));
    textures.push_back(texture_of(flat, TextureWrap::repeat, TextureWrap::repeat));
    materials.push_back({.name = std::to_string(k), .texture = k});
  }
  const Hierarchy h = striped(materials, textures);
  const TileAtlas atlas = atlas_of(h, CellId(0));
  PixelImage image = decode_image(atlas.images.at(0).bytes, "image/png");
  for (int level = 0; level < 4; ++level) {
    for_each_point(h, CellId(0), atlas, [&](std::uint32_t material, Vec2f, Vec2f after) {
      ASSERT_NEAR(sampled(image, after, TextureWrap::clamp, TextureWrap::clamp)[0], 30.0 * material, 1e-3) << level;
    });
    image = to_pixels(halve(image, PixelMeaning::values), PixelMeaning::values);
  }
}

// Materials that differ in more than colours, or repeat too often, keep their own.
TEST_F(TileAtlases, KeepApartWhatDiffers) {
  std::vector<Texture> textures{texture_of(patterned({16, 16}, 1), TextureWrap::repeat, TextureWrap::repeat),
                                texture_of(patterned({32, 32}, 2), TextureWrap::repeat, TextureWrap::repeat)};
  std::vector<Material> materials(strips, textured_material());
  materials[1].alpha_mode = materials[3].alpha_mode = AlphaMode::mask;
  materials[2].roughness = 0.5f;
  materials[4].normal_map = materials[5].normal_map = 1;
  const Hierarchy h = striped(materials, textures);
  const TileAtlas atlas = atlas_of(h, CellId(0));
  EXPECT_EQ(atlas.replacing(1), atlas.replacing(3));
  EXPECT_FALSE(atlas.replacing(2));  // nobody to share with
  EXPECT_EQ(atlas.replacing(4), atlas.replacing(5));
  EXPECT_EQ(atlas.replacing(0), atlas.replacing(6));
  EXPECT_NE(atlas.replacing(0), atlas.replacing(1));
  EXPECT_EQ(atlas.materials.size(), 3u);
  EXPECT_EQ(atlas.images.size(), 4u);  // colours of three, normals of one
  EXPECT_EQ(atlas.materials[*atlas.replacing(1)].alpha_mode, AlphaMode::mask);
  EXPECT_NE(atlas.materials[*atlas.replacing(4)].normal_map, no_texture);
  const Hierarchy often = striped(materials, textures, 5);
  const TileAtlas none = atlas_of(often, CellId(0));
  EXPECT_TRUE(none.materials.empty());
  EXPECT_EQ(none.repeating, strips);
}

TEST_F(TileAtlases, FewMaterialsAreLeftAsTheyAre) {
  const std::vector<Texture> textures{texture_of(patterned({16, 16}, 1), TextureWrap::repeat, TextureWrap::repeat)};
  EXPECT_TRUE(atlas_of(striped(std::vector<Material>(4, textured_material()), textures), CellId(0)).materials.empty());
  EXPECT_FALSE(atlas_of(striped(std::vector<Material>(5, textured_material()), textures), CellId(0)).materials.empty());
}

// Colours that differ go into the pixels; a material without a texture is a patch of its colour.
TEST_F(TileAtlases, BaseColoursAreMultipliedIn) {
  const PixelImage grey{
      .size = {8, 8}, .channels = 3, .pixels = std::vector<std::uint8_t>(8 * 8 * 3, 188)};  // 0.5 light
  const std::vector<Texture> textures{texture_of(grey, TextureWrap::repeat, TextureWrap::repeat)};
  std::vector<Material> materials(strips, textured_material());
  for (std::uint32_t k = 0; k < strips; ++k) {
    materials[k].base_colour = {1, 0.125f * static_cast<float>(k), 0.25f, 1};
    if (k % 2) materials[k].texture = no_texture;
  }
  const Hierarchy h = striped(materials, textures);
  const TileAtlas atlas = atlas_of(h, CellId(0));
  ASSERT_EQ(atlas.materials.size(), 1u);
  EXPECT_EQ(atlas.materials[0].base_colour, (std::array<float, 4>{1, 1, 1, 1}));
  const PixelImage image = decode_image(atlas.images[0].bytes, "image/png");
  for_each_point(h, CellId(0), atlas, [&](std::uint32_t m, Vec2f, Vec2f after) {
    const auto found = sampled(image, after, TextureWrap::clamp, TextureWrap::clamp);
    for (std::size_t c = 0; c < 3; ++c) {
      const double light = (m % 2 ? 1 : 0.5029) * double{materials[m].base_colour[c]};
      ASSERT_NEAR(found[c], 255 * linear_to_srgb(light), 1) << m;
    }
  });
}

// Where alpha counts, that of the base colour does, too.
TEST_F(TileAtlases, AlphaOfBaseColoursIsKept) {
  PixelImage half{.size = {8, 8}, .channels = 4, .pixels = std::vector<std::uint8_t>(8 * 8 * 4, 128)};
  const std::vector<Texture> textures{texture_of(half, TextureWrap::repeat, TextureWrap::repeat)};
  for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend}) {
    std::vector<Material> materials(strips, textured_material());
    for (std::uint32_t k = 0; k < strips; ++k) {
      materials[k].alpha_mode = mode;
      materials[k].base_colour[3] = 0.125f * static_cast<float>(k + 1);
      if (k % 2) materials[k].texture = no_texture;
    }
    const Hierarchy h = striped(materials, textures);
    const TileAtlas atlas = atlas_of(h, CellId(0));
    ASSERT_EQ(atlas.materials.size(), 1u);
    EXPECT_EQ(atlas.materials[0].alpha_mode, mode);
    EXPECT_EQ(atlas.materials[0].base_colour[3], 1);
    const PixelImage image = decode_image(atlas.images[0].bytes, "image/png");
    ASSERT_EQ(image.channels, mode == AlphaMode::opaque ? 3u : 4u);
    for_each_point(h, CellId(0), atlas, [&](std::uint32_t m, Vec2f, Vec2f after) {
      const double alpha = (m % 2 ? 255 : 128) * double{materials[m].base_colour[3]};
      const double found = sampled(image, after, TextureWrap::clamp, TextureWrap::clamp)[3];
      ASSERT_NEAR(found, mode == AlphaMode::opaque ? 255 : alpha, 0.51) << m;
    });
  }
}

// Textures that do not fit into one image keep their own, the largest first.
TEST_F(TileAtlases, KeepWithinTheLongestSide) {
  std::vector<Texture> textures;
  std::vector<Material> materials;
  for (std::uint32_t k = 0; k < strips; ++k) {
    textures.push_back(texture_of(patterned({32, 32 + 256 * (k / 7)}, k), TextureWrap::repeat, TextureWrap::repeat));
    materials.push_back({.name = std::to_string(k), .texture = k});
  }
  const Hierarchy h = striped(materials, textures);
  const auto longest = [](const TileAtlas& atlas) {
    const PixelSize size = image_size(atlas.images.at(0).bytes, "image/png");
    return std::max(size.width, size.height);
  };
  DecodedImages images(h, 1);
  TileAtlasConfig config{.pixels = [&](std::uint32_t t) { return images.get(t, 0); }};
  config.longest_side = longest(make_tile_atlas(h, CellId(0), config)) - 8;
  const TileAtlas atlas = make_tile_atlas(h, CellId(0), config);
  EXPECT_LE(longest(atlas), config.longest_side);
  std::string which;
  for (std::uint32_t m = 0; m < strips; ++m) which += atlas.replacing(m) ? '1' : '0';
  EXPECT_EQ(which, "11111110") << config.longest_side;
  config.longest_side = 16;
  EXPECT_TRUE(make_tile_atlas(h, CellId(0), config).materials.empty());
}

TEST(DecodedImages, AreKeptWhileThereIsRoom) {
  std::vector<Texture> textures;
  for (std::uint32_t k = 0; k < 3; ++k)
    textures.push_back(texture_of(patterned({32, 32}, k), TextureWrap::repeat, TextureWrap::repeat));
  textures.push_back({"", "image/png", TextureWrap::repeat, TextureWrap::repeat, {'n', 'o', 'n', 'e'}});
  const Hierarchy h = striped({textured_material()}, textures);
  DecodedImages many(h, std::size_t{1} << 20), few(h, 2 * 32 * 32 * 3);
  const auto first = many.get(0, 0), first_of_few = few.get(0, 0);
  for (const std::uint32_t texture : {1u, 2u, 3u, 3u}) {
    EXPECT_EQ(many.get(texture, 0) == nullptr, texture == 3);
    (void)few.get(texture, 0);
  }
  EXPECT_EQ(many.get(0, 0), first);
  EXPECT_NE(few.get(0, 0), first_of_few);
}

}  // namespace
}  // namespace lodestone
