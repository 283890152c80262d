// Materials and images of a glTF file.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/formats/common/companion_files.h"
#include "core/formats/gltf/gltf_document.h"
#include "core/formats/gltf/misplaced_maps.h"
#include "core/math/vec3.h"
#include "core/mesh/indexed_mesh.h"
#include "core/mesh/uv_map.h"

namespace lodestone {

// A material with the texture coordinates that its textures use: those of its first texture, base colour before the
// others.
struct GltfMaterial {
  std::uint32_t index = no_material;  // in mesh.materials; a material that says nothing is none
  std::string uv_attribute = "TEXCOORD_0";
  UvMap uv_map{1, 0, 0, 1, 0, 0};        // KHR_texture_transform of that texture
  std::vector<std::size_t> misplaced{};  // GltfMaterials::misplaced() that are on other coordinates
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
  [[nodiscard]] MisplacedMaps& misplaced() { return misplaced_; }
  // Call when all materials have been used. One line for each feature of them that was left out or changed.
  [[nodiscard]] std::vector<std::string> finish();

 private:
  GltfMaterial read(const JsonView& source);
  void read_base_colour(const JsonView& source, GltfMaterial& placement, Material& material);
  PlacedTexture place(const JsonView& info, GltfMaterial& placement);
  std::uint32_t read_image(const JsonView& reference, const TextureSampler& sampler);

  GltfDocument* document_;
  RawMesh* mesh_;
  TextureSet textures_;
  std::map<std::uint64_t, GltfMaterial> used_;
  std::map<std::pair<std::uint64_t, TextureSampler>, std::uint32_t> images_;
  MisplacedMaps misplaced_;
  std::map<std::string, std::uint64_t> left_out_;  // by what is said of them: number of materials
};

}  // namespace lodestone
