// The attributes of a surface: normals, colours, texture coordinates, and the material of each triangle.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/triangle.h"
#include "core/math/vec2.h"
#include "core/math/vec3.h"
#include "core/mesh/material.h"

namespace lodestone {

// In the sRGB encoding, alpha linear; white where a file gives no colour.
struct Rgba8 {
  std::uint8_t r = 255, g = 255, b = 255, a = 255;
  friend constexpr bool operator==(const Rgba8&, const Rgba8&) = default;
};

// The axes of a normal map in tangent space, as glTF has them (core/mesh/tangents.h).
struct Tangent {
  Vec3f along_u{1, 0, 0};  // of unit length, perpendicular to the normal: where u grows
  float side = 1;          // -1 where texture coordinates are mirrored: cross(normal, along_u) * side is where v falls
  friend bool operator==(const Tangent&, const Tangent&) = default;
};

// A wedge is a vertex as some of its triangles use it: a position and one value of each attribute. Along a seam a
// vertex has several wedges. As positions of a RawMesh are not welded, wedges of a RawMesh may have equal values: files
// that store every triangle's corners apart have three for each triangle.
//
// An attribute that the file has anywhere is an array of one value per wedge; where the file gives none, it is
// texture coordinate (0, 0), the zero normal and white. An absent attribute is an empty array, and a mesh without any
// attribute costs nothing.
struct RawWedges {
  std::vector<Vec2f> uv;      // as in glTF: (0, 0) is the upper left corner of the image, y runs down
  std::vector<Vec3f> normal;  // of unit length, or zero: unknown
  std::vector<Rgba8> colour;
  // The wedge at each corner of each triangle; every wedge belongs to one vertex. Empty: the wedges are the vertices.
  std::vector<Triangle> corners;
  std::vector<std::uint32_t> material;  // per triangle: index into the mesh's materials, or no_material; or empty

  [[nodiscard]] bool empty() const { return uv.empty() && normal.empty() && colour.empty(); }
  friend bool operator==(const RawWedges&, const RawWedges&) = default;
};

}  // namespace lodestone
