// The textures of a mesh, each image file once.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <tuple>

#include "core/files/byte_reader.h"
#include "core/formats/common/companion_files.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

struct TextureWraps {
  TextureWrap u = TextureWrap::repeat, v = TextureWrap::repeat;
};

// What a material shows that names a texture for its colour which cannot be had: a plain magenta, which nobody takes
// for the model's own.
inline constexpr std::array<float, 4> missing_texture_colour{1, 0, 1, 1};
// `texture`: as a TextureSet gives it for the material's colour.
inline void set_colour_texture(Material& material, std::uint32_t texture) {
  material.texture = texture;
  if (texture == no_texture) material.base_colour = missing_texture_colour;
}

// Adds to mesh.textures; what cannot be had is a warning and no_texture, for the surface is sound without it.
class TextureSet {
 public:
  TextureSet(RawMesh& mesh, const ByteReader& input) : mesh_(&mesh), files_(input.folder()), file_(input.name()) {}

  // The image of this name beside the mesh. `place` is where the mesh names it.
  [[nodiscard]] std::uint32_t add_file(const std::string& name, const std::string& place, TextureWraps wraps = {});
  // An image that lies in the mesh file.
  [[nodiscard]] std::uint32_t add_bytes(const std::string& name, const std::string& place, std::vector<char> bytes,
                                        TextureWraps wraps = {});

 private:
  std::uint32_t refuse(const std::string& name, const std::string& place, const std::string& why);

  RawMesh* mesh_;
  CompanionFiles files_;
  std::string file_;
  std::map<std::tuple<std::string, TextureWrap, TextureWrap>, std::uint32_t> known_;  // by path
};

}  // namespace lodestone
