// The material of a surface as an object of glTF, for every file that holds one: .gltf, .glb, .lode, .lpm.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/files/json.h"
#include "core/files/json_view.h"
#include "core/mesh/attributes.h"

namespace lodestone {

// A member of the extensions of an object.
[[nodiscard]] std::optional<JsonView> extension(const JsonView& value, const char* name);

// The texture that a textureInfo names and its place on the mesh; no_texture to leave it out.
using ReadTexture = std::function<PlacedTexture(const JsonView& info)>;
// The same where indices are those of the mesh, `count` of them, as surface_json() writes them. Throws InputError for
// others.
[[nodiscard]] ReadTexture textures_of_mesh(std::size_t count);

// All of the material except its name, base colour and the textures of colour and normals. Numbers of textures are
// those of the mesh; textures that are not below texture_count are left out.
[[nodiscard]] Json surface_json(const Material& material, std::size_t texture_count);
// The inverse; members that are missing have the defaults of glTF, in which a surface is metallic. Throws InputError
// for values of another kind.
void read_surface(const JsonView& source, const ReadTexture& read_texture, Material& material);

// KHR_materials_emissive_strength: the factor of the emissive colour; 1 without it.
[[nodiscard]] float emissive_strength(const Material& material);
// Sets it; 1 leaves it out.
void set_emissive_strength(Material& material, float strength);

// True for the numbers of OpenGL that a sampler's filters have, and for 0, the viewer's choice.
[[nodiscard]] constexpr bool is_filter(std::uint64_t number) {
  return number == 0 || number == 9728 || number == 9729 || (number >= 9984 && number <= 9987);
}

// KHR_texture_transform of a textureInfo; the default without one.
[[nodiscard]] UvTransform read_uv_transform(const JsonView& info);
// A textureInfo.
[[nodiscard]] Json texture_info(const PlacedTexture& texture);

// Adds to `names` the extensions that a material uses.
void list_extensions(const Json& material, Json& names);

}  // namespace lodestone
