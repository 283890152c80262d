#include "core/hierarchy/model/texture_levels.h"

#include <algorithm>

#include "core/texture/downsample.h"

namespace lodestone {
namespace {

PixelMeaning meaning_of(const Hierarchy& hierarchy, std::uint32_t texture) {
  bool colours = false, normals = false;
  for (const Material& m : hierarchy.materials) {
    colours = colours || m.texture == texture;
    normals = normals || m.normal_map == texture;
  }
  return normals && !colours ? PixelMeaning::normals : PixelMeaning::colours;
}

}  // namespace

std::vector<TextureCopy> make_texture_copies(const Hierarchy& hierarchy, std::uint32_t texture, int most) {
  std::vector<TextureCopy> copies;
  const Texture& source = hierarchy.textures[texture];
  const auto fits = [](PixelSize size) { return std::min(size.width, size.height) >= 2 * least_texture_side; };
  if (most < 1 || !fits(image_size(source.bytes, source.media_type))) return copies;
  const PixelMeaning meaning = meaning_of(hierarchy, texture);
  PixelImage pixels = decode_image(source.bytes, source.media_type);
  const int chroma = pixels.chroma;
  LinearImage image = to_linear(pixels, meaning);
  pixels = {};
  for (std::uint32_t halvings = 1; halvings <= static_cast<std::uint32_t>(most) && fits(image.size); ++halvings) {
    image = halve(image);
    PixelImage half = to_pixels(image, meaning);
    half.chroma = chroma;
    copies.push_back({texture, halvings, image.size.width, image.size.height, encode_image(half, source.media_type)});
  }
  return copies;
}

const TextureCopy* texture_copy(const Hierarchy& hierarchy, std::uint32_t texture, int level) {
  const auto halvings = static_cast<std::uint32_t>(hierarchy.finest() - level);
  const TextureCopy* best = nullptr;
  for (const TextureCopy& copy : hierarchy.texture_copies)
    if (copy.texture == texture && copy.halvings <= halvings) best = &copy;
  return best;
}

std::vector<Texture> level_textures(const Hierarchy& hierarchy, int level) {
  std::vector<Texture> textures = hierarchy.textures;
  for (std::uint32_t t = 0; t < textures.size(); ++t)
    if (const TextureCopy* copy = texture_copy(hierarchy, t, level)) textures[t].bytes = copy->bytes;
  return textures;
}

}  // namespace lodestone
