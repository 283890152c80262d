#include "core/progressive/mesh/thumbnails.h"

#include <optional>

#include "core/base/error.h"
#include "core/progressive/mesh/texture_meanings.h"
#include "core/texture/thumbnail.h"

namespace lodestone {

std::vector<Texture> make_thumbnails(const ProgressiveMesh& mesh, const Runner& runner) {
  const std::vector<std::optional<PixelMeaning>> meanings = texture_meanings(mesh);
  std::vector<Texture> out(mesh.wedges.textures.size());
  runner.run(out.size(), [&](std::size_t k, std::size_t) {
    if (!meanings[k]) return;
    try {
      out[k] = thumbnail_of(mesh.wedges.textures[k], *meanings[k]);
    } catch (const InputError&) {  // a file keeps images that are damaged or foreign as they are
    } catch (const UnsupportedError&) {
    }
  });
  return out;
}

}  // namespace lodestone
