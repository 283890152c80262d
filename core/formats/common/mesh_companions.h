// Files beside a mesh that is written: its material library and its images.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/files/atomic_file.h"
#include "core/mesh/attributes.h"

namespace lodestone {

// Names of companions begin with the stem of the mesh file, in which characters that would end a name in a mesh file
// (blanks, '#', quotes, backslashes, control characters) become '_'. A mesh written to a pipe or device has none.
class MeshCompanions {
 public:
  explicit MeshCompanions(const std::filesystem::path& mesh);

  [[nodiscard]] bool possible() const { return possible_; }
  // Writes the file STEM + suffix and returns its name. The file appears with commit(), and not at all without.
  std::string add(const std::string& suffix, std::span<const std::byte> bytes);
  std::string add_texture(const Texture& texture, std::size_t number);
  void commit();

 private:
  std::filesystem::path folder_;
  std::string stem_;
  bool possible_;
  std::vector<std::unique_ptr<AtomicFile>> files_;
};

// ".jpg" and so on, by the media type.
[[nodiscard]] std::string image_extension(const std::string& media_type);

}  // namespace lodestone
