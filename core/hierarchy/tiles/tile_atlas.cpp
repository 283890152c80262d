#include "core/hierarchy/tiles/tile_atlas.h"

#include <algorithm>
#include <array>
#include <map>

#include "core/hierarchy/tiles/atlas_image.h"
#include "core/hierarchy/tiles/atlas_parts.h"

namespace lodestone {
namespace {

using atlas::Use, atlas::map_count, atlas::maps_of;

void set_map(Material& m, std::size_t map, std::uint32_t image) {
  std::size_t next = 0;
  for_each_texture(m, [&](std::uint32_t& texture) {
    if (next++ == map) texture = image;
  });
}

// The material without what may differ within an atlas, which is name, textures and base colour. Colours may have a
// texture or not; another map is there for all or for none.
Material common_part(Material m) {
  m.name.clear();
  m.base_colour = {1, 1, 1, 1};
  m.texture = no_texture;
  for (std::size_t map = atlas::normals; map < map_count; ++map)
    if (maps_of(m)[map] != no_texture) set_map(m, map, 0);
  return m;
}

class AtlasMaker {
 public:
  AtlasMaker(const Hierarchy& hierarchy, CellId cell, const TileAtlasConfig& config)
      : hierarchy_(hierarchy),
        cell_(hierarchy.cells[cell]),
        config_(config),
        parent_(config.morph && cell_.parent != no_cell ? &hierarchy.cells[cell_.parent] : nullptr) {}

  TileAtlas make() {
    if (!hierarchy_.attributes.materials) return {};
    find_uses();
    if (uses_.size() <= config_.most_materials) return {};
    std::vector<std::pair<Material, std::vector<Use*>>> groups;
    for (auto& [number, use] : uses_) {
      if (!prepare(use)) continue;
      const Material part = common_part(hierarchy_.materials[number]);
      auto group = std::ranges::find(groups, part, [](const auto& g) -> const Material& { return g.first; });
      if (group == groups.end()) group = groups.insert(group, {part, {}});
      group->second.push_back(&use);
    }
    atlas_.replaced_by.assign(hierarchy_.materials.size(), no_material);
    for (auto& [material, uses] : groups) add_atlas(material, std::move(uses));
    if (atlas_.materials.empty()) atlas_.replaced_by.clear();
    return std::move(atlas_);
  }

 private:
  void find_uses() {
    std::vector<bool> known(cell_.positions.size());
    for (const Triangle& t : cell_.triangles) {
      const std::uint32_t material = cell_.attributes.materials[t.v[0]];
      if (material >= hierarchy_.materials.size()) continue;
      Use& use = uses_[material];
      use.material = material;
      for (const std::uint32_t v : t.v) {
        if (known[v]) continue;
        known[v] = true;
        use.vertices.push_back(v);
      }
    }
  }

  // Finds images and parts; false if the material is left as it is.
  bool prepare(Use& use) {
    const Material& m = hierarchy_.materials[use.material];
    const std::array placements{m.normal_transform, m.metallic_roughness.transform, m.occlusion.transform,
                                m.emissive_map.transform};
    if (!m.extension_textures.empty()) return false;
    if (std::ranges::any_of(placements, [](const UvTransform& t) { return t != UvTransform{}; })) return false;
    const Texture* first = nullptr;
    for (std::size_t map = 0; map < map_count; ++map) {
      const std::uint32_t texture = maps_of(m)[map];
      if (texture == no_texture) continue;
      const Texture& source = hierarchy_.textures[texture];
      if (first && (source.wrap_u != first->wrap_u || source.wrap_v != first->wrap_v)) return false;
      first = &source;
      use.maps[map] = config_.pixels(texture);
      if (!use.maps[map] || !hierarchy_.attributes.uv) return false;
      const PixelSize size = use.maps[map]->size;
      use.size = {std::max(use.size.width, size.width), std::max(use.size.height, size.height)};
    }
    if (!first) {
      use.parts = {{0, 0, atlas::plain_side, atlas::plain_side}};
      return true;
    }
    use.wrap_u = first->wrap_u, use.wrap_v = first->wrap_v;
    if (atlas::find_parts(cell_, parent_, use)) return true;
    ++atlas_.repeating;
    return false;
  }

  // An atlas for as many of the materials as have room in it, the largest left out first.
  void add_atlas(Material material, std::vector<Use*> uses) {
    std::optional<PixelSize> size;
    while (uses.size() > 1 && !(size = atlas::pack(uses, config_.longest_side))) {
      const auto texels = [](const Use* use) {
        std::uint64_t sum = 0;
        for (const atlas::TexelBox& box : use->parts) sum += atlas::padded_area(box);
        return sum;
      };
      uses.erase(std::ranges::max_element(uses, {}, texels));
    }
    if (!size) return;
    const Material& first = hierarchy_.materials[uses.front()->material];
    const bool same_colour = std::ranges::all_of(
        uses, [&](const Use* use) { return hierarchy_.materials[use->material].base_colour == first.base_colour; });
    if (same_colour) material.base_colour = first.base_colour;
    for (std::size_t map = 0; map < map_count; ++map) {
      if (std::ranges::none_of(
              uses, [&](const Use* use) { return use->maps[map] || (map == atlas::colours && !same_colour); }))
        continue;
      set_map(material, map, static_cast<std::uint32_t>(atlas_.images.size()));
      atlas_.images.push_back(atlas::encode(hierarchy_, uses, map, *size, !same_colour));
    }
    const auto number = static_cast<std::uint32_t>(atlas_.materials.size());
    atlas_.materials.push_back(std::move(material));
    for (const Use* use : uses) {
      atlas_.replaced_by[use->material] = number;
      place_vertices(*use, *size);
    }
  }

  void place_vertices(const Use& use, PixelSize size) {
    if (atlas_.uv.empty()) {
      atlas_.uv.assign(cell_.positions.size(), {});
      if (hierarchy_.attributes.uv) std::ranges::copy(cell_.attributes.uv, atlas_.uv.begin());
      if (parent_) atlas_.parent_uv = atlas_.uv;
      for (std::uint32_t v = 0; parent_ && hierarchy_.attributes.uv && v < atlas_.uv.size(); ++v)
        atlas_.parent_uv[v] = atlas::parent_uv(cell_, *parent_, v);
    }
    for (std::size_t k = 0; k < use.vertices.size(); ++k) {
      const std::uint32_t v = use.vertices[k];
      atlas_.uv[v] = placed(use, k, size, atlas_.uv[v]);
      if (parent_) atlas_.parent_uv[v] = placed(use, k, size, atlas_.parent_uv[v]);
    }
  }

  // The place in the atlas of a coordinate of vertex k of a use.
  static Vec2f placed(const Use& use, std::size_t k, PixelSize size, Vec2f uv) {
    const std::size_t part = use.part_of.empty() ? 0 : use.part_of[k];
    const atlas::TexelBox& box = use.parts[part];
    const PagePlace& at = use.places[part];
    if (use.part_of.empty())
      return {static_cast<float>((at.x + atlas::gutter + atlas::plain_side / 2.0) / size.width),
              static_cast<float>((at.y + atlas::gutter + atlas::plain_side / 2.0) / size.height)};
    const auto along = [](double t, std::int64_t shift, std::uint32_t texels, std::int64_t first, std::uint32_t to,
                          std::uint32_t side) {
      const double texel = (t - static_cast<double>(shift)) * texels - static_cast<double>(first);
      return static_cast<float>((texel + to + atlas::gutter) / side);
    };
    return {along(uv.x, use.shift[k][0], use.size.width, box.x0, at.x, size.width),
            along(uv.y, use.shift[k][1], use.size.height, box.y0, at.y, size.height)};
  }

  const Hierarchy& hierarchy_;
  const Cell& cell_;
  const TileAtlasConfig& config_;
  const Cell* parent_;                 // null: the tile does not morph
  std::map<std::uint32_t, Use> uses_;  // by material
  TileAtlas atlas_;
};

}  // namespace

TileAtlas make_tile_atlas(const Hierarchy& hierarchy, CellId cell, const TileAtlasConfig& config) {
  return AtlasMaker(hierarchy, cell, config).make();
}

}  // namespace lodestone
