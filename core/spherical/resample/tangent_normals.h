// Normals in tangent space from those in object space: for viewers that know no others.
//
// The frame at a point of a triangle is that of the glTF viewers of three.js and Khronos: tangent, bitangent and normal
// of the corners, each interpolated and brought to unit length, not made perpendicular again. A normal map in tangent
// space, made with the exact inverse of these frames, gives the normals back.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/math/vec3.h"
#include "core/mesh/tangents.h"
#include "core/texture/downsample.h"

namespace lodestone::spherical {

// Triangles in the octahedral square, and what belongs to their corners. All spans must outlive it.
struct FramedMesh {
  std::span<const Triangle> triangles;
  std::span<const Vec2f> uv;
  std::span<const Vec3f> normals;
  std::span<const Tangent> tangents;
};

// Three axes of unit length, or zero.
struct TangentFrame {
  Vec3d along_u, up, normal;
  [[nodiscard]] Vec3d to_object(Vec3d n) const { return n.x * along_u + (n.y * up + n.z * normal); }
  // The inverse, up to its length. Zero if the axes are in one plane.
  [[nodiscard]] Vec3d to_tangent(Vec3d n) const;
};
[[nodiscard]] TangentFrame frame_at(const FramedMesh& mesh, const Triangle& triangle,
                                    const std::array<double, 3>& weight);

// A map of size x size pixels in tangent space of an octahedral image of normals. Pixels at the sides of the square are
// made for the points on the sides, so that both copies of a point on the cut show the same normal, as `object` has it.
// A normal that points into the surface is laid on it: the format has no others. Pixels on no triangle get the mean of
// their neighbours.
[[nodiscard]] LinearImage tangent_normals(const FramedMesh& mesh, const LinearImage& object, std::uint32_t size);

// The angle, in degrees, between the normal that a viewer shows by `map`, and that of `object`, at a point of a
// triangle. `map` without pixels: the viewer shows the normals of the corners.
[[nodiscard]] double shown_angle(const FramedMesh& mesh, const Triangle& triangle, const std::array<double, 3>& weight,
                                 const LinearImage& map, const LinearImage& object);

}  // namespace lodestone::spherical
