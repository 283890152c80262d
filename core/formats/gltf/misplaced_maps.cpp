#include "core/formats/gltf/misplaced_maps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "core/texture/image_codec.h"

namespace lodestone {
namespace {

Texture with_image(const Texture& source, const PlacedImage& drawn) {
  Texture made = source;
  made.bytes = encode_image(drawn.image, source.media_type);
  made.wrap_u = drawn.wrap_u, made.wrap_v = drawn.wrap_v;
  return made;
}

std::optional<Texture> redrawn(const Texture& source, const MisplacedMaps::Map& map) {
  try {
    const PlacedImage image{decode_image(source.bytes, source.media_type), source.wrap_u, source.wrap_v};
    if (const std::optional<PlacedImage> drawn = redraw(image, map.meaning, map.triangles))
      return with_image(source, *drawn);
  } catch (const Error&) {  // it cannot be decoded, which the caller says
  }
  return std::nullopt;
}

PlaneTriangle in_plane(const std::array<Vec2f, 3>& uv) {
  PlaneTriangle out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = {uv[k].x, uv[k].y};
  return out;
}

// The map from the coordinates of the mesh to those of the image, where one does for all triangles to 1/4096.
std::optional<UvTransform> common_transform(std::span<const RedrawTriangle> triangles) {
  const auto largest = std::ranges::max_element(triangles, {}, [](const auto& t) { return doubled_area(t.to); });
  if (largest == triangles.end()) return std::nullopt;
  const std::optional<UvMap> map = map_between(in_plane(largest->to), in_plane(largest->from));
  if (!map) return std::nullopt;
  const auto& [a, b, c, d, x, y] = *map;
  for (const RedrawTriangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [u, v] = t.to[k];
      if (!(std::abs(a * u + b * v + x - t.from[k].x) < 1.0 / 4096)) return std::nullopt;
      if (!(std::abs(c * u + d * v + y - t.from[k].y) < 1.0 / 4096)) return std::nullopt;
    }
  return transform_after(map_of(UvTransform{}), *map);
}

// False for maps of extensions.
bool place(Material& m, const MisplacedMaps::Map& map, const UvTransform& transform) {
  bool found = false;
  const auto set = [&](std::uint32_t& texture, UvTransform& at) {
    if (texture == map.texture) texture = map.source, at = transform, found = true;
  };
  set(m.normal_map, m.normal_transform);
  for (PlacedTexture* use : {&m.metallic_roughness, &m.occlusion, &m.emissive_map}) set(use->texture, use->transform);
  return found;
}

void drop_unused_textures(RawMesh& mesh) {
  std::vector<std::uint32_t> number(mesh.textures.size(), no_texture);
  for (const Material& m : mesh.materials)
    for_each_texture(m, [&](std::uint32_t texture) {
      if (texture != no_texture) number[texture] = 0;
    });
  std::uint32_t kept = 0;
  for (std::uint32_t t = 0; t < number.size(); ++t) {
    if (number[t] == no_texture) continue;
    if (kept != t) mesh.textures[kept] = std::move(mesh.textures[t]);
    number[t] = kept++;
  }
  mesh.textures.resize(kept);
  for (Material& m : mesh.materials)
    for_each_texture(m, [&](std::uint32_t& texture) {
      if (texture != no_texture) texture = number[texture];
    });
}

}  // namespace

std::uint32_t MisplacedMaps::add(RawMesh& mesh, std::uint32_t source, Map map) {
  map.source = source;
  map.texture = static_cast<std::uint32_t>(mesh.textures.size());
  mesh.textures.push_back({});
  maps_.push_back(std::move(map));
  return maps_.back().texture;
}

std::vector<std::string> MisplacedMaps::finish(RawMesh& mesh) {
  if (maps_.empty()) return {};
  std::size_t drawn = 0, left_out = 0;
  for (const Map& map : maps_) {
    if (const auto transform = common_transform(map.triangles))
      if (place(mesh.materials[map.material], map, *transform)) continue;
    if (std::optional<Texture> made = redrawn(mesh.textures[map.source], map)) {
      mesh.textures[map.texture] = std::move(*made);
      ++drawn;
      continue;
    }
    ++left_out;
    for_each_texture(mesh.materials[map.material], [&](std::uint32_t& texture) {
      if (texture == map.texture) texture = no_texture;
    });
  }
  maps_.clear();
  drop_unused_textures(mesh);
  std::vector<std::string> lines;
  if (drawn > 0)
    lines.push_back(std::to_string(drawn) +
                    " textures are drawn anew: on the coordinates of the first texture of their material");
  if (left_out > 0)
    lines.push_back(std::to_string(left_out) +
                    " textures are left out: they use other texture coordinates than the first texture of their "
                    "material, which repeats where they do not, or cannot be decoded");
  return lines;
}

}  // namespace lodestone
