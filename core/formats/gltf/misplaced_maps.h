// Maps of materials that a transform of the mesh's texture coordinates cannot place: they use another set of them than
// the rest of their material, or are skewed against it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "core/mesh/uv_map.h"
#include "core/texture/redraw.h"

namespace lodestone {

class MisplacedMaps {
 public:
  struct Map {
    std::uint32_t material = no_material;  // of the mesh
    std::uint32_t texture = no_texture;    // of the mesh; a place held for the image to be made
    std::uint32_t source = no_texture;
    std::string uv_attribute;  // its coordinates in the file, and what maps them to the image
    UvMap uv_map{1, 0, 0, 1, 0, 0};
    PixelMeaning meaning = PixelMeaning::values;
    std::vector<RedrawTriangle> triangles{};  // that show the material
  };

  // Adds a texture to the mesh that stands for the map until finish(). Returns its number.
  std::uint32_t add(RawMesh& mesh, std::uint32_t source, Map map);
  [[nodiscard]] std::vector<Map>& maps() { return maps_; }

  // Places what a transform can place after all, draws the other images anew, on the coordinates of the mesh
  // (core/texture/redraw.h), and leaves out those for which that is impossible. Textures in no use are removed.
  // Returns a line for each of the two.
  [[nodiscard]] std::vector<std::string> finish(RawMesh& mesh);

 private:
  std::vector<Map> maps_;
};

}  // namespace lodestone
