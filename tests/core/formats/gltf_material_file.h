// Small glTF files with a material, read and written again.
#pragma once

#include <string>
#include <vector>

#include "core/formats/gltf/gltf.h"
#include "core/mesh/raw_mesh.h"
#include "tests/core/formats/gltf_test_util.h"

namespace lodestone {

// A triangle with two sets of texture coordinates and this material, which may use textures 0 to 6.
inline GltfFile file_with(const nlohmann::json& material) {
  GltfFile file;
  const std::size_t position = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const std::size_t uv = file.floats({0, 0, 1, 0, 0.25f, 1}, "VEC2"), other = file.floats({0, 0, 0, 1, 1, 0}, "VEC2");
  for (std::size_t k = 0; k < 7; ++k) {
    const std::size_t view = file.view(png_bytes(std::to_string(k)));
    file.push("images", {{"bufferView", view}, {"mimeType", "image/png"}, {"name", std::to_string(k)}});
    file.push("textures", {{"source", k}, {"sampler", 0}});
  }
  file.push("samplers", {{"magFilter", 9728}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33648}});
  file.push("materials", material);
  file.show({{{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}, {"TEXCOORD_1", other}}}, {"material", 0}}});
  return file;
}

inline nlohmann::json placed(std::size_t texture, const nlohmann::json& transform) {
  return {{"index", texture}, {"extensions", {{"KHR_texture_transform", transform}}}};
}

// Every value differs from its default.
inline nlohmann::json rich_material() {
  return {{"name", "rich"},
          {"pbrMetallicRoughness",
           {{"baseColorFactor", {1, 0.5, 0.25, 0.75}},
            {"baseColorTexture", {{"index", 0}}},
            {"metallicFactor", 0.5},
            {"roughnessFactor", 0.25},
            {"metallicRoughnessTexture", {{"index", 1}}}}},
          {"normalTexture", {{"index", 2}, {"scale", 0.5}}},
          {"occlusionTexture", {{"index", 1}, {"strength", 0.75}}},
          {"emissiveFactor", {0.5, 0.25, 1}},
          {"emissiveTexture", placed(3, {{"offset", {0.5, 0.25}}, {"rotation", 0.5}, {"scale", {2, -3}}})},
          {"alphaMode", "MASK"},
          {"alphaCutoff", 0.25},
          {"doubleSided", true},
          {"extensions",
           {{"KHR_materials_unlit", nlohmann::json::object()},
            {"KHR_materials_ior", {{"ior", 1.25}}},
            {"KHR_materials_clearcoat",
             {{"clearcoatFactor", 0.5},
              {"clearcoatTexture", {{"index", 4}}},
              {"clearcoatNormalTexture",
               {{"index", 5}, {"scale", 2}, {"extensions", {{"KHR_texture_transform", {{"offset", {1, 0}}}}}}}}}}}}};
}

inline RawMesh read_material(const nlohmann::json& material) {
  return read_bytes(file_with(material).glb(), MeshFormat::gltf);
}

inline RawMesh written_and_read(const RawMesh& mesh) {
  const std::vector<std::byte> bytes = encode_glb(view_of(mesh));
  return read_bytes({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, MeshFormat::gltf);
}

}  // namespace lodestone
