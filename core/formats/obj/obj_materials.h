// The materials that the triangles of an OBJ file use, from the libraries it names.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/formats/common/companion_files.h"
#include "core/formats/common/texture_set.h"
#include "core/formats/obj/mtl_reader.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Adds to mesh.materials and mesh.textures what is used. A library or an image that is missing or damaged is a warning;
// a material that no library knows is white and keeps its name.
class ObjMaterials {
 public:
  ObjMaterials(RawMesh& mesh, const ByteReader& input)
      : mesh_(&mesh), files_(input.folder()), file_(input.name()), textures_(mesh, input) {}

  // "mtllib NAMES": one name that may hold blanks, or several without.
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
  std::map<std::string, Entry> known_;         // by name; the first of a name counts
  std::map<std::string, std::uint32_t> used_;  // index by name
};

}  // namespace lodestone
