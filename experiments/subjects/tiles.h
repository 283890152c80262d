// A tileset as the user names it: a folder, or an archive of it (.3tz).
#pragma once

#include <cstdint>
#include <string>

#include "core/files/json.h"
#include "parallel/hierarchy/save_tiles.h"

namespace lodestone {

[[nodiscard]] bool is_tile_archive(const std::string& target);
// The folder that files are written into: the target, or one beside an archive, which is gone in the end.
[[nodiscard]] std::string tile_folder(const std::string& target);

// Makes the written files whole under the target; `bytes` of an archive become those of the one file. Throws Cancelled,
// and what the folder and write_tile_archive throw.
void finish_tiles(AtomicFolder& folder, const std::string& target, const CancelFlag& cancel, SavedTiles& saved);

[[nodiscard]] Json to_json(const SavedTiles& saved, const std::string& target, std::uint64_t finest_triangles);
[[nodiscard]] std::string summary(const SavedTiles& saved, const std::string& target);  // a line

}  // namespace lodestone
