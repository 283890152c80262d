// The files that a mesh file names: buffers, material libraries, images, tiles.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/attributes.h"

namespace lodestone {

// Files are looked for beside the one that names them.
class CompanionFiles {
 public:
  // Without a folder nothing is found.
  explicit CompanionFiles(std::optional<std::filesystem::path> folder = {}) : folder_(std::move(folder)) {}

  // The file of this name: as it stands, relative to the folder; with backslashes for slashes; and, as models move
  // more often than the paths in them are mended, its last part alone. Empty when there is no such file, also for an
  // absolute path or an address of the web.
  [[nodiscard]] std::optional<std::filesystem::path> find(std::string_view name) const;
  // Its bytes; empty when it is not found or cannot be read.
  [[nodiscard]] std::optional<std::vector<char>> read(std::string_view name) const;

 private:
  std::optional<std::filesystem::path> folder_;
};

// "a%20b.png" as "a b.png". Broken escapes stay.
[[nodiscard]] std::string percent_decoded(std::string_view uri);

// The bytes of "data:[MEDIA TYPE];base64,...": empty when it is of another encoding, or damaged.
[[nodiscard]] bool is_data_uri(std::string_view uri);
[[nodiscard]] std::optional<std::vector<char>> decode_data_uri(std::string_view uri);

// By the first bytes: image/png, image/jpeg, image/webp or image/ktx2; empty for anything else, so that no other file
// becomes a part of a model because a material names it.
[[nodiscard]] std::string image_media_type(std::string_view bytes);

}  // namespace lodestone
