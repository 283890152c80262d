#include "core/hierarchy/texture_levels.h"

#include <algorithm>

namespace lodestone {

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
