// The looks of a surface for the sphere: the colours and normals of the mesh that it was made from, at any point of its
// triangles.
//
// A colour is base colour of the material times texture times vertex colour, in linear light; or the values of another
// image of the material, as the mesh's source says (SourceLook). A normal is from the
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
#include "core/spherical/surface.h"
#include "core/texture/source_texture.h"

namespace lodestone::spherical {

// A point of a triangle by barycentric weights.
struct SurfacePoint {
  std::uint32_t triangle = 0;
  std::array<float, 3> weight{};
};

// Ranges of taps: where they begin and end.
struct SurfaceTaps {
  std::uint32_t colour_begin = 0, colour_end = 0, normal_begin = 0, normal_end = 0;
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
  // The same for four points, whose weights are those of the second and third corners.
  struct Weights4 {
    Float4 b, c;
  };
  struct Coordinates4 {
    Float4 u, v;
  };
  [[nodiscard]] Coordinates4 uv(const std::array<std::uint32_t, 4>& triangles, const Weights4& points) const;
  // And around them, along changes of their weights.
  [[nodiscard]] Footprint4 footprints(const std::array<std::uint32_t, 4>& triangles, const Weights4& points,
                                      const Weights4& by_x, const Weights4& by_y) const;
  // Light times alpha, and alpha; or values. The footprint is in texture coordinates.
  [[nodiscard]] Float4 colour(const SurfacePoint& point, const Footprint& footprint) const;
  // A unit vector, or zero where nothing tells the normal.
  [[nodiscard]] Vec3f normal(const SurfacePoint& point, const Footprint& footprint) const;

  // Both of the points of one footprint, in two steps as SourceTexture has them; the sum of all their weights is 1.
  // With normals, the taps of the colour may serve for both.
  struct Looks {
    bool colour = true, normal = true;
  };
  // For the first lanes: as many as there are triangles.
  void add_taps(std::span<const std::uint32_t> triangles, const Footprint4& footprints, Looks looks, TapList& taps,
                std::span<SurfaceTaps> to) const;
  [[nodiscard]] Float4 colour(std::span<const SurfacePoint> points, std::span<const TextureTap> taps) const;
  // The value of the normal map that bends the normals of a triangle, zero without one; the fourth component is not
  // zero if it is the normal itself, in object space.
  [[nodiscard]] Float4 mapped_normal(std::uint32_t triangle, std::span<const TextureTap> taps) const;
  // normal() in lanes: for each point its normal, bent by a mapped one, times the sum of its weights. Bent normals need
  // not be of unit length. The number of points is a multiple of 4.
  void set_normals(std::span<const SurfacePoint> points, std::span<const Float4> mapped, std::span<Float4> to) const;

 private:
  // A triangle as samples need it, in one place: they come from all over the mesh.
  struct alignas(64) Patch {
    Vec2f uv, to_b, to_c;  // the first corner's, and from there to the others'
    float uv_scale = 0;
    std::uint32_t chart = no_source;  // no_source: without a source
    std::uint32_t shade = 0;          // of the source
    std::uint32_t is_part = 0;        // 1: parts_ has its corners
    Vec3f to_u, to_v;                 // in which its texture coordinates grow, in space
  };
  [[nodiscard]] const MeshSource::Shade& shade_of(std::uint32_t triangle) const {
    return source_->shade(patches_[triangle].shade);
  }
  [[nodiscard]] static Vec2f along(const Patch& patch, const std::array<float, 3>& weight) {
    return {weight[1] * patch.to_b.x + weight[2] * patch.to_c.x, weight[1] * patch.to_b.y + weight[2] * patch.to_c.y};
  }
  struct Patch4 {
    Coordinates4 uv, to_b, to_c;
  };
  [[nodiscard]] Patch4 patches(const std::array<std::uint32_t, 4>& triangles) const;
  [[nodiscard]] static Coordinates4 along(const Patch4& patch, const Weights4& weight);
  // At four points: the smooth normal, of any length, and where the texture coordinates grow.
  struct Frame4 {
    Float4x3 normal, to_u, to_v;
  };
  [[nodiscard]] Frame4 frame_of(std::uint32_t triangle, const Float4x3& weight) const;
  [[nodiscard]] Frame4 frame_of(std::span<const SurfacePoint, 4> points) const;
  void match_corners(const Surface& surface);
  void add_coordinates(const Surface& surface, std::span<const Vec3d> directions);
  void match_part(const Surface& surface, std::uint32_t triangle);
  // The weights of the source's corners.
  [[nodiscard]] std::array<float, 3> weights(const SurfacePoint& point) const;
  [[nodiscard]] Float4 vertex_colour(const SurfacePoint& point) const;
  [[nodiscard]] Vec3f smooth_normal(const SurfacePoint& point) const;
  void set_frame(std::uint32_t triangle);

  // The weights of the source's corners at each corner of a triangle.
  using CornerWeights = std::array<std::array<float, 3>, 3>;

  std::shared_ptr<const MeshSource> source_;
  const IndexedMesh& mesh_;
  std::vector<Triangle> corners_;  // by triangle of the surface: wedges of the mesh; no_source: none
  std::vector<Patch> patches_;     // likewise
  std::unordered_map<std::uint32_t, CornerWeights> parts_;  // of triangles turned over, and of parts of their source
};

}  // namespace lodestone::spherical
