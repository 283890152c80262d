// The looks of a mesh that surfaces for the sphere are made from: what its components share. Textures are decoded once,
// however many components they are on.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/lanes/float4.h"
#include "core/mesh/indexed_mesh.h"
#include "core/mesh/uv_map.h"
#include "core/texture/source_texture.h"

namespace lodestone::spherical {

// A source shows normals with base colours and colours of vertices, or another of the materials' images, each channel
// where glTF has it; all multiplied by the factors of the materials. Alpha counts only in colours of those that are not
// opaque.
enum class SourceLook : std::uint8_t { colours_and_normals, metal_and_roughness, occlusion, emission };

// The largest KHR_materials_emissive_strength of a mesh, at least 1: its light is shown as a share of that.
[[nodiscard]] float strongest_emission(const IndexedMesh& mesh);

class MeshSource {
 public:
  // A material, ready to be sampled.
  struct Shade {
    Float4 factor{1, 1, 1, 1};                                    // of colours: light times alpha, and alpha
    Float4 added{};                                               // to the product of factor and texture
    std::uint32_t texture = no_texture, normal_map = no_texture;  // of texture()
    UvMap place{1, 0, 0, 1, 0, 0};                                // of the texture on the mesh's coordinates
    bool opaque = true;
  };
  struct LoadedTexture {
    std::uint32_t texture = 0;  // of the mesh
    PixelMeaning meaning = PixelMeaning::colours;
    bool opaque = true;         // its alpha is left out
    bool object_space = false;  // of normals (core/texture/normal_space.h)
    SourceTexture image{};
  };

  // The mesh must outlive it. Linear time.
  explicit MeshSource(const IndexedMesh& mesh, SourceLook look = SourceLook::colours_and_normals);

  // Textures have to be loaded before they are sampled. May run side by side. Throws what decode_image throws, with the
  // texture's name.
  [[nodiscard]] std::size_t texture_count() const { return textures_.size(); }
  void load(std::size_t texture);

  [[nodiscard]] const IndexedMesh& mesh() const { return mesh_; }
  [[nodiscard]] const LoadedTexture& texture(std::uint32_t number) const { return textures_[number]; }
  [[nodiscard]] bool has_vertex_colours() const {
    return look_ == SourceLook::colours_and_normals && !mesh_.wedges.colour.empty();
  }
  // The first is that of triangles without a material.
  [[nodiscard]] const Shade& shade(std::uint32_t number) const { return shades_[number]; }
  // The coordinates of a wedge in the texture of its shade.
  [[nodiscard]] Vec2f uv(std::uint32_t wedge) const;
  // By wedge: equal in a triangle.
  [[nodiscard]] std::uint32_t shade_number(std::uint32_t wedge) const;
  // By wedge: equal for wedges that triangles connect.
  [[nodiscard]] std::uint32_t chart(std::uint32_t wedge) const { return charts_[wedge]; }
  // By wedge: the mesh's own, else the mean of the triangles', by area; of unit length, or zero.
  [[nodiscard]] const std::vector<Vec3f>& normals() const { return normals_; }

 private:
  [[nodiscard]] std::uint32_t loaded(std::uint32_t texture, PixelMeaning meaning, bool opaque);
  [[nodiscard]] Shade shade_of(const Material& material);
  void find_charts();
  void add_normals();

  const IndexedMesh& mesh_;
  SourceLook look_;
  std::vector<Shade> shades_;
  std::vector<LoadedTexture> textures_;
  std::vector<std::uint32_t> charts_;
  std::vector<Vec3f> normals_;
};

}  // namespace lodestone::spherical
