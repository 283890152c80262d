#include "core/progressive/mesh/thumbnails.h"

#include <optional>

#include "core/base/error.h"
#include "core/progressive/mesh/texture_meanings.h"
#include "core/texture/thumbnail.h"

namespace lodestone {
std::vector<Texture> make_thumbnails(const ProgressiveMesh& mesh) {
  const std::vector<std::optional<PixelMeaning>> meanings = texture_meanings(mesh);
  std::vector<Texture> out(mesh.wedges.textures.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (!meanings[k]) continue;
    try {
      out[k] = thumbnail_of(mesh.wedges.textures[k], *meanings[k]);
    } catch (const InputError&) {  // a file keeps images that are damaged or foreign as they are
    } catch (const UnsupportedError&) {
    }
  }
  return out;
}

}  // namespace lodestone
