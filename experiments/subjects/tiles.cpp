#include "experiments/subjects/tiles.h"

#include <fmt/core.h>

#include "experiments/subjects/tile_archive.h"

namespace lodestone {

bool is_tile_archive(const std::string& target) { return std::filesystem::path(target).extension() == ".3tz"; }

std::string tile_folder(const std::string& target) { return is_tile_archive(target) ? target + ".files" : target; }

void finish_tiles(AtomicFolder& folder, const std::string& target, const CancelFlag& cancel, SavedTiles& saved) {
  // Workers finish tiles in any order; files packed afterwards are in the same order always.
  if (is_tile_archive(target))
    saved.bytes = write_tile_archive(folder.path(), target, cancel);
  else
    folder.commit();
}

Json to_json(const SavedTiles& saved, const std::string& target, std::uint64_t finest_triangles) {
  return {{is_tile_archive(target) ? "file" : "folder", target},
          {"tiles", saved.tiles},
          {"tilesets", saved.tilesets},
          {"textures", saved.textures},
          {"atlases", saved.atlases},
          {"draws", saved.draws},
          {"triangles", saved.triangles},
          {"finest_triangles", finest_triangles},
          {"bytes", saved.bytes},
          {"warnings", saved.warnings}};
}

std::string summary(const SavedTiles& saved, const std::string& target) {
  return fmt::format("{}: {} tiles with {} draws, {} tilesets, {} images, {} triangles, {:.1f} MB\n", target,
                     saved.tiles, saved.draws, saved.tilesets, saved.textures, saved.triangles,
                     static_cast<double>(saved.bytes) * 1e-6);
}

}  // namespace lodestone
