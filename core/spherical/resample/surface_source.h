// The looks of a surface for the sphere: the colours and normals of the mesh that it was made from, at any point of its
// triangles.
//
// A colour is base colour of the material times texture times vertex colour, in linear light. A normal is from the
// material's normal map, in object or tangent space (core/texture/normal_space.h), or the normals of the
// corners interpolated; a mesh without normals gets means of its triangles', by area.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/base/prefetch.h"
#include "core/math/lanes/float4.h"
#include "core/mesh/indexed_mesh.h"
#include "core/spherical/resample/mesh_source.h"
#include "core/spherical/resample/source_texture.h"
#include "core/spherical/surface.h"

namespace lodestone::spherical {

// A point of a triangle by barycentric weights.
struct SurfacePoint {
  std::uint32_t triangle = 0;
  std::array<float, 3> weight{};
};

// The directions on a triangle in which its texture coordinates grow.
struct TextureFrame {
  std::uint32_t triangle = no_source;
  Vec3f to_u, to_v;
};

// Ranges of taps: where they begin and end.
struct SurfaceTaps {
  std::size_t colour_begin = 0, colour_end = 0, normal_begin = 0, normal_end = 0;
};

class SurfaceSource {
 public:
  // The source's mesh, which must outlive it, is the one that the surface's source_vertex and source_triangle name; its
  // textures are loaded before they are sampled. directions: one per vertex of the surface; they tell the size of
  // footprints. Throws InputError if a triangle and its source have different corners.
  SurfaceSource(std::shared_ptr<const MeshSource> source, const Surface& surface, std::span<const Vec3d> directions);

  // False for triangles that fill holes or cap cuts: nothing below may be asked of them.
  [[nodiscard]] bool has(std::uint32_t triangle) const { return patches_[triangle].chart != no_source; }
  // Asks for a triangle that samples will be taken from.
  void prefetch(std::uint32_t triangle) const { lodestone::prefetch(&patches_[triangle]); }
  // Equal for triangles that are connected in texture coordinates.
  [[nodiscard]] std::uint32_t chart(std::uint32_t triangle) const { return patches_[triangle].chart; }
  // Texture coordinates per unit of length on the sphere, the mean over all directions; 0 without a texture.
  [[nodiscard]] float uv_scale(std::uint32_t triangle) const { return patches_[triangle].uv_scale; }
  [[nodiscard]] Vec2f uv(const SurfacePoint& point) const {
    const Patch& patch = patches_[point.triangle];
    const Vec2f within = along(patch, point.weight);
    return {patch.uv.x + within.x, patch.uv.y + within.y};
  }
  // Around a point, along changes of its weights, of sum 0.
  [[nodiscard]] Footprint footprint(const SurfacePoint& point, const std::array<float, 3>& by_x,
                                    const std::array<float, 3>& by_y) const {
    const Patch& patch = patches_[point.triangle];
    return {uv(point), along(patch, by_x), along(patch, by_y)};
  }
  // Light times alpha, and alpha. The footprint is in texture coordinates.
  [[nodiscard]] Float4 colour(const SurfacePoint& point, const Footprint& footprint) const;
  // A unit vector, or zero where nothing tells the normal.
  [[nodiscard]] Vec3f normal(const SurfacePoint& point, const Footprint& footprint) const;

  // Both of the points of one footprint, in two steps as SourceTexture has them; the sum of all their weights is 1.
  // With normals, the taps of the colour may serve for both.
  struct Looks {
    bool colour = true, normal = true;
  };
  [[nodiscard]] SurfaceTaps add_taps(std::uint32_t triangle, const Footprint& footprint, Looks looks,
                                     TapList& taps) const;
  [[nodiscard]] Float4 colour(std::span<const SurfacePoint> points, std::span<const TextureTap> taps) const;
  // frame: that of the last call, as neighbours are often in one triangle.
  [[nodiscard]] Vec3f normal(std::span<const SurfacePoint> points, std::span<const TextureTap> taps,
                             TextureFrame& frame) const;

 private:
  // A triangle as samples need it, in one place: they come from all over the mesh.
  struct Patch {
    Vec2f uv, to_b, to_c;  // the first corner's, and from there to the others'
    float uv_scale = 0;
    std::uint32_t chart = no_source;  // no_source: without a source
    std::uint32_t shade = 0;          // of the source
  };
  [[nodiscard]] const MeshSource::Shade& shade_of(std::uint32_t triangle) const {
    return source_->shade(patches_[triangle].shade);
  }
  [[nodiscard]] static Vec2f along(const Patch& patch, const std::array<float, 3>& weight) {
    return {weight[1] * patch.to_b.x + weight[2] * patch.to_c.x, weight[1] * patch.to_b.y + weight[2] * patch.to_c.y};
  }
  void match_corners(const Surface& surface);
  void add_coordinates(const Surface& surface, std::span<const Vec3d> directions);
  void match_part(const Surface& surface, std::uint32_t triangle);
  // The weights of the source's corners.
  [[nodiscard]] std::array<float, 3> weights(const SurfacePoint& point) const;
  [[nodiscard]] Float4 vertex_colour(const SurfacePoint& point) const;
  [[nodiscard]] Vec3f smooth_normal(const SurfacePoint& point) const;
  [[nodiscard]] TextureFrame frame_of(std::uint32_t triangle) const;

  // The weights of the source's corners at each corner of a triangle.
  using CornerWeights = std::array<std::array<float, 3>, 3>;

  std::shared_ptr<const MeshSource> source_;
  const IndexedMesh& mesh_;
  std::vector<Triangle> corners_;  // by triangle of the surface: wedges of the mesh; no_source: none
  std::vector<Patch> patches_;     // likewise
  std::unordered_map<std::uint32_t, CornerWeights> parts_;  // of triangles turned over, and of parts of their source
};

}  // namespace lodestone::spherical
