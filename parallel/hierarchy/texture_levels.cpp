#include "parallel/hierarchy/texture_levels.h"

#include <iterator>
#include <utility>

#include "core/base/error.h"
#include "core/hierarchy/model/level_mesh.h"

namespace lodestone {

std::vector<std::string> add_texture_copies(Hierarchy& hierarchy, Scheduler& scheduler, const CancelFlag* cancel) {
  const std::size_t count = hierarchy.textures.size();
  std::vector<std::vector<TextureCopy>> copies(count);
  std::vector<std::string> refusals(count);
  scheduler.for_chunks(count, 1, [&](ChunkRange range) {
    if (cancel && *cancel) throw Cancelled{};
    const auto texture = static_cast<std::uint32_t>(range.begin);
    try {
      copies[texture] = make_texture_copies(hierarchy, texture, hierarchy.doublings(0));
    } catch (const Error& error) {
      refusals[texture] = "texture '" + hierarchy.textures[texture].name + "' " + error.what() +
                          "; all levels show it in full resolution";
    }
  });
  hierarchy.texture_copies.clear();
  std::vector<std::string> warnings;
  for (std::size_t t = 0; t < count; ++t) {
    std::move(copies[t].begin(), copies[t].end(), std::back_inserter(hierarchy.texture_copies));
    if (!refusals[t].empty()) warnings.push_back(std::move(refusals[t]));
  }
  return warnings;
}

}  // namespace lodestone
