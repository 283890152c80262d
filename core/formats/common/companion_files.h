// The files that a mesh file names (buffers, material libraries, images, tiles), and its textures.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/files/byte_reader.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Looks for files beside the one that names them. A model that someone else has made must not take any file of this
// computer into what is made of it: names that lead out of the folder's limit are not followed, unless it has none.
class CompanionFiles {
 public:
  // Without a folder nothing is found.
  explicit CompanionFiles(std::optional<CompanionFolder> folder = {}) : folder_(std::move(folder)) {}

  // The file of this name, relative to the folder; else with slashes for its backslashes; else its last part alone,
  // since models move more often than the paths in them are corrected. Empty when there is no such file within the
  // limit, and for a web address. Without a limit, absolute paths and "file:///PATH" are found, too.
  [[nodiscard]] std::optional<std::filesystem::path> find(std::string_view name) const;
  // The same by the name alone, as tilesets mean it.
  [[nodiscard]] std::optional<std::filesystem::path> find_exactly(std::string_view name) const;
  // Why a file is not found, for messages, and what to do.
  struct Absence {
    std::string what, remedy;
  };
  [[nodiscard]] Absence absence(std::string_view name) const;
  // Its bytes; empty when it is not found or cannot be read.
  [[nodiscard]] std::optional<std::vector<char>> read(std::string_view name) const;

 private:
  // True if the name leads out of the limit, whether or not there is such a file.
  [[nodiscard]] bool leads_outside(std::string_view name) const;

  std::optional<CompanionFolder> folder_;
};

// "a%20b.png" as "a b.png". Invalid escapes are kept.
[[nodiscard]] std::string percent_decoded(std::string_view uri);

// The bytes of "data:[MEDIA TYPE];base64,...": empty if the encoding is another one or the data is damaged.
[[nodiscard]] bool is_data_uri(std::string_view uri);
[[nodiscard]] std::optional<std::vector<char>> decode_data_uri(std::string_view uri);

// Told from the first bytes: image/png, image/jpeg, image/webp or image/ktx2; empty for anything else, so that no other
// file becomes a part of a model because a material names it.
[[nodiscard]] std::string image_media_type(std::string_view bytes);

// How an image continues beyond its edges and is filtered between its texels, as in Texture.
struct TextureSampler {
  TextureWrap u = TextureWrap::repeat, v = TextureWrap::repeat;
  std::uint16_t mag_filter = 0, min_filter = 0;
  friend auto operator<=>(const TextureSampler&, const TextureSampler&) = default;
};

// The colour of a material whose texture is missing: plain magenta, which is not mistaken for a colour of the model.
inline constexpr std::array<float, 4> missing_texture_colour{1, 0, 1, 1};
// `texture`: what a TextureSet returned for the material's colour.
inline void set_colour_texture(Material& material, std::uint32_t texture) {
  material.texture = texture;
  if (texture == no_texture) material.base_colour = missing_texture_colour;
}

// Adds to mesh.textures, each image file once; a missing or invalid one is a warning and no_texture, since the surface
// is valid without it.
class TextureSet {
 public:
  TextureSet(RawMesh& mesh, const ByteReader& input) : mesh_(&mesh), files_(input.folder()), file_(input.name()) {}

  // The image of this name beside the mesh. `place` is where the mesh names it.
  [[nodiscard]] std::uint32_t add_file(const std::string& name, const std::string& place,
                                       const TextureSampler& sampler = {});
  // An image inside the mesh file.
  [[nodiscard]] std::uint32_t add_bytes(const std::string& name, const std::string& place, std::vector<char> bytes,
                                        const TextureSampler& sampler = {});

 private:
  std::uint32_t refuse(const std::string& name, const std::string& place, const std::string& why,
                       const std::string& remedy = {});

  RawMesh* mesh_;
  CompanionFiles files_;
  std::string file_;
  std::map<std::pair<std::string, TextureSampler>, std::uint32_t> known_;  // by path
};

}  // namespace lodestone
