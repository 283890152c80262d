// The material of a surface, by the names and with the meaning that glTF 2.0 gives them, and its textures.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

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

}  // namespace lodestone
