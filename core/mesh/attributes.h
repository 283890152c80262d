// The attributes of a surface: normals, colours, texture coordinates, materials, textures.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/math/triangle.h"
#include "core/math/vec2.h"
#include "core/math/vec3.h"

namespace lodestone {

// In the sRGB encoding, alpha linear; white where a file gives no colour.
struct Rgba8 {
  std::uint8_t r = 255, g = 255, b = 255, a = 255;
  friend constexpr bool operator==(const Rgba8&, const Rgba8&) = default;
};

enum class TextureWrap : std::uint8_t { repeat, clamp, mirror };

// An image as stored in its file, not decoded.
struct Texture {
  std::string name;        // as the mesh names it
  std::string media_type;  // told from the bytes: image/png, image/jpeg, image/webp or image/ktx2
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
  std::vector<char> bytes;
  friend bool operator==(const Texture&, const Texture&) = default;
};

inline constexpr std::uint32_t no_texture = 0xFFFF'FFFFu, no_material = 0xFFFF'FFFFu;

struct Material {
  std::string name;
  std::array<float, 4> base_colour{1, 1, 1, 1};  // linear, in [0, 1]; times texture and vertex colour
  std::uint32_t texture = no_texture;            // of the base colour; an index into the mesh's textures
  std::uint32_t normal_map = no_texture;         // likewise
  friend bool operator==(const Material&, const Material&) = default;
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
