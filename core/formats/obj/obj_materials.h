// Material libraries (.mtl), and the materials that the triangles of an OBJ file use.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/common/companion_files.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// A statement such as "map_Kd -clamp on wood.png".
struct MtlTexture {
  std::string file;
  TextureSampler sampler;
  std::string place;  // line of the library
};

struct MtlMaterial {
  std::string name;
  std::array<float, 4> colour{1, 1, 1, 1};  // Kd and d (or 1 - Tr)
  std::optional<MtlTexture> texture;        // map_Kd
  std::optional<MtlTexture> normal_map;     // norm, map_Bump or bump
};

// Reads the statements newmtl, Kd, d, Tr, map_Kd, norm, map_Bump and bump; others are skipped, and all options of maps
// but -clamp. Colours are clamped to [0, 1]. Throws InputError naming the line for a statement without its values.
[[nodiscard]] std::vector<MtlMaterial> read_mtl(ByteReader& input);

// Adds the materials and textures that are used to the mesh. A library or an image that is missing or damaged is a
// warning; a material that no library defines is white and keeps its name.
class ObjMaterials {
 public:
  ObjMaterials(RawMesh& mesh, const ByteReader& input)
      : mesh_(&mesh), files_(input.folder()), file_(input.name()), textures_(mesh, input) {}

  // "mtllib NAMES": one name that may have blanks, or several without.
  void add_libraries(const std::string& names, const std::string& place);
  // "usemtl NAME": the index of the material.
  [[nodiscard]] std::uint32_t use(const std::string& name, const std::string& place);

 private:
  void add_library(const std::string& name, const std::string& place);

  struct Entry {
    MtlMaterial material;
    std::string library;
  };

  RawMesh* mesh_;
  CompanionFiles files_;
  std::string file_;
  TextureSet textures_;
  std::map<std::string, Entry> known_;         // by name; the first definition counts
  std::map<std::string, std::uint32_t> used_;  // index by name
};

}  // namespace lodestone
