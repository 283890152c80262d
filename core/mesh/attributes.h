// The attributes of a surface: normals, colours, texture coordinates, and the material of each triangle, by the names
// and with the meaning that glTF 2.0 gives it, with its textures.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone {

enum class TextureWrap : std::uint8_t { repeat, clamp, mirror };

// An image as stored in its file, not decoded.
struct Texture {
  std::string name;        // as the mesh names it
  std::string media_type;  // told from the bytes: image/png, image/jpeg, image/webp or image/ktx2
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
  std::vector<char> bytes;
  std::uint16_t mag_filter = 0, min_filter = 0;  // numbers of OpenGL, for other viewers; 0: the viewer's choice
  friend bool operator==(const Texture&, const Texture&) = default;
};

inline constexpr std::uint32_t no_texture = 0xFFFF'FFFFu, no_material = 0xFFFF'FFFFu;

// Coordinates in a texture from those of the mesh: scaled, then turned, then moved (KHR_texture_transform).
struct UvTransform {
  std::array<float, 2> offset{0, 0}, scale{1, 1};
  float rotation = 0;  // radians
  friend bool operator==(const UvTransform&, const UvTransform&) = default;
};

struct PlacedTexture {
  std::uint32_t texture = no_texture;  // index into the mesh's textures
  UvTransform transform{};
  friend bool operator==(const PlacedTexture&, const PlacedTexture&) = default;
};

enum class AlphaMode : std::uint8_t { opaque, mask, blend };

// The default is what a mesh without a material is drawn with: white, without metal, rough, seen from both sides.
struct Material {
  std::string name;
  std::array<float, 4> base_colour{1, 1, 1, 1};  // linear, in [0, 1]; times texture and vertex colour
  std::uint32_t texture = no_texture;            // of the base colour; an index into the mesh's textures
  std::uint32_t normal_map = no_texture;         // likewise

  UvTransform normal_transform{};
  float normal_scale = 1;
  float metallic = 0, roughness = 1;   // in [0, 1]
  PlacedTexture metallic_roughness{};  // roughness in green, metal in blue
  PlacedTexture occlusion{};           // in red
  float occlusion_strength = 1;        // in [0, 1]
  std::array<float, 3> emissive{};     // linear, in [0, 1]; times its texture
  PlacedTexture emissive_map{};
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;  // of AlphaMode::mask: less is not drawn
  bool double_sided = true;   // false: seen from the side from which its triangles turn anticlockwise
  bool unlit = false;
  // Other extensions of glTF (KHR_materials_*), carried without knowing what they mean: an object in JSON, or empty. An
  // "index" of a texture in it is one of extension_textures.
  std::string extensions{};
  std::vector<std::uint32_t> extension_textures{};

  friend bool operator==(const Material&, const Material&) = default;
};

// Calls visit(number) with each place for a texture, in use or no_texture.
template <class AnyMaterial, class Visit>
void for_each_texture(AnyMaterial& m, const Visit& visit) {
  for (auto* texture :
       {&m.texture, &m.normal_map, &m.metallic_roughness.texture, &m.occlusion.texture, &m.emissive_map.texture})
    visit(*texture);
  for (auto& texture : m.extension_textures) visit(texture);
}

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
