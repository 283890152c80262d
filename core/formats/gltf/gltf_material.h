// Materials and images of a glTF file.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "core/formats/common/companion_files.h"
#include "core/formats/gltf/gltf_document.h"
#include "core/math/vec2.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// A material with the texture coordinates that its base colour uses.
struct GltfMaterial {
  std::uint32_t index = no_material;  // in mesh.materials
  std::string uv_attribute = "TEXCOORD_0";
  // KHR_texture_transform: (u, v) -> (a u + b v + x, c u + d v + y).
  std::array<double, 6> uv_map{1, 0, 0, 1, 0, 0};  // a, b, c, d, x, y
  [[nodiscard]] Vec2f map(double u, double v) const;
};

// Adds the materials that are used, with their images, to the mesh. The base colour is that of pbrMetallicRoughness, or
// the diffuse one of KHR_materials_pbrSpecularGlossiness. A missing or invalid image is a warning.
class GltfMaterials {
 public:
  GltfMaterials(GltfDocument& document, const ByteReader& input, RawMesh& mesh)
      : document_(&document), mesh_(&mesh), textures_(mesh, input) {}

  // `reference`: the value that holds the index.
  [[nodiscard]] const GltfMaterial& use(const JsonView& reference);
  // The texture that a textureInfo names, added to the mesh; no_texture if there is no image.
  [[nodiscard]] std::uint32_t read_texture(const JsonView& info);

 private:
  GltfMaterial read(const JsonView& source);
  std::uint32_t read_image(const JsonView& reference, TextureWraps wraps);

  GltfDocument* document_;
  RawMesh* mesh_;
  TextureSet textures_;
  std::map<std::uint64_t, GltfMaterial> used_;
  std::map<std::tuple<std::uint64_t, TextureWrap, TextureWrap>, std::uint32_t> images_;
};

}  // namespace lodestone
