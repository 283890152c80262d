// Material libraries (.mtl), and the materials that the triangles of an OBJ file use.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
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
  float bump = 1;     // -bm
};

struct MtlMaterial {
  std::string name;
  std::array<float, 4> colour{1, 1, 1, 1};  // Kd and d (or 1 - Tr)
  std::optional<MtlTexture> texture;        // map_Kd
  std::optional<MtlTexture> normal_map;     // norm, map_Bump or bump
  std::array<float, 3> emission{};          // Ke
  std::optional<MtlTexture> emission_map;   // map_Ke
  std::optional<float> roughness, metal;    // Pr, Pm
  std::set<std::string> left_out;           // what else it says about the surface, in words
};

// Reads the statements newmtl, Kd, d, Tr, Ke, Pr, Pm, map_Kd, map_Ke, norm, map_Bump and bump, and the options -clamp
// and -bm of maps. Others are skipped; those that would change the look of a surface, with values that do so, are
// listed in left_out. Not among them are Ka, Ni and illum: viewers have their own ambient light and refraction. Colours
// are clamped to [0, 1]. Throws InputError naming the line for a statement without its values.
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
  // A warning for each kind of statement that materials in use have and that was left out.
  void add_notes();

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
  std::set<std::filesystem::path> libraries_;    // that have been read
  std::map<std::string, Entry> known_;           // by name; the first definition counts
  std::map<std::string, std::uint32_t> used_;    // index by name
  std::map<std::string, std::size_t> left_out_;  // number of materials
};

}  // namespace lodestone
