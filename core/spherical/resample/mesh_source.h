// The looks of a mesh that surfaces for the sphere are made from: what its components share. Textures are decoded once,
// however many components they are on.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/lanes/float4.h"
#include "core/mesh/indexed_mesh.h"
#include "core/texture/source_texture.h"

namespace lodestone::spherical {

class MeshSource {
 public:
  // A material, ready to be sampled.
  struct Shade {
    Float4 base_colour{1, 1, 1, 1};                               // light times alpha, and alpha
    std::uint32_t texture = no_texture, normal_map = no_texture;  // of texture()
  };
  struct LoadedTexture {
    std::uint32_t texture = 0;  // of the mesh
    PixelMeaning meaning = PixelMeaning::colours;
    bool object_space = false;  // of normals (core/texture/normal_space.h)
    SourceTexture image;
  };

  // The mesh must outlive it. Linear time.
  explicit MeshSource(const IndexedMesh& mesh);

  // Textures have to be loaded before they are sampled. May run side by side. Throws what decode_image throws, with the
  // texture's name.
  [[nodiscard]] std::size_t texture_count() const { return textures_.size(); }
  void load(std::size_t texture);

  [[nodiscard]] const IndexedMesh& mesh() const { return mesh_; }
  [[nodiscard]] const LoadedTexture& texture(std::uint32_t number) const { return textures_[number]; }
  // The first is that of triangles without a material.
  [[nodiscard]] const Shade& shade(std::uint32_t number) const { return shades_[number]; }
  // By wedge: equal in a triangle.
  [[nodiscard]] std::uint32_t shade_number(std::uint32_t wedge) const;
  // By wedge: equal for wedges that triangles connect.
  [[nodiscard]] std::uint32_t chart(std::uint32_t wedge) const { return charts_[wedge]; }
  // By wedge: the mesh's own, else the mean of the triangles', by area; of unit length, or zero.
  [[nodiscard]] const std::vector<Vec3f>& normals() const { return normals_; }

 private:
  [[nodiscard]] std::uint32_t loaded(std::uint32_t texture, PixelMeaning meaning);
  void add_shades();
  void find_charts();
  void add_normals();

  const IndexedMesh& mesh_;
  std::vector<Shade> shades_;
  std::vector<LoadedTexture> textures_;
  std::vector<std::uint32_t> charts_;
  std::vector<Vec3f> normals_;
};

}  // namespace lodestone::spherical
