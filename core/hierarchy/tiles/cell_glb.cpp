// One cell as binary glTF.
#include <algorithm>
#include <map>
#include <span>

#include "core/formats/gltf/glb_builder.h"
#include "core/hierarchy/model/material_of.h"
#include "core/hierarchy/tiles/tileset_tree.h"
#include "core/texture/colour.h"

namespace lodestone {
namespace {

constexpr std::uint32_t unseen = 0xffff'ffffu;

class CellEncoder {
 public:
  CellEncoder(const Hierarchy& hierarchy, CellId cell, const CellGlbConfig& config)
      : hierarchy_(hierarchy),
        id_(cell),
        cell_(hierarchy.cells[cell]),
        config_(config),
        atlas_(config.atlas && !config.atlas->materials.empty() ? config.atlas : nullptr),
        morph_(config.morph && cell_.parent != no_cell),
        places_(morph_ && config.signatures ? config.signatures->places(cell) : std::span<const std::uint8_t>{}) {}

  std::vector<std::byte> encode() {
    place_node();
    number_vertices();
    if (morph_ && config_.signatures) sort_by_signature();
    add_vertices();
    add_primitives();
    add_materials();
    return glb_.finish();
  }

 private:
  // (x, y, z) -> scale (x, z, -y), by columns.
  void place_node() {
    const double s = hierarchy_.transform.scale;
    glb_.root["scene"] = 0;
    glb_.root["scenes"] = {{{"nodes", {0}}}};
    glb_.root["nodes"] = {{{"mesh", 0}, {"matrix", {s, 0, 0, 0, 0, 0, -s, 0, 0, s, 0, 0, 0, 0, 0, 1}}}};
  }

  // Numbers vertices in the order in which triangles use them.
  void number_vertices() {
    number_.assign(cell_.positions.size(), unseen);
    for (const Triangle& t : cell_.triangles)
      for (const std::uint32_t v : t.v) {
        if (number_[v] != unseen) continue;
        number_[v] = static_cast<std::uint32_t>(used_.size());
        used_.push_back(v);
      }
  }

  // A few counts then tell all vertices their signatures.
  void sort_by_signature() {
    const std::size_t first_shared = cell_.positions.size() - places_.size();
    const auto place = [&](std::uint32_t v) { return v < first_shared ? std::size_t{0} : places_[v - first_shared]; };
    std::ranges::stable_sort(used_, {}, place);
    std::vector<std::uint32_t> counts(config_.signatures->of(id_).size());
    for (std::size_t k = 0; k < used_.size(); ++k) {
      number_[used_[k]] = static_cast<std::uint32_t>(k);
      ++counts[place(used_[k])];
    }
    glb_.root["meshes"][0]["extras"]["signatures"] = counts;
  }

  template <class Value>
  std::size_t add_values(const Value& value, GltfComponent component, const char* type) {
    std::vector<decltype(value(0u))> values;
    values.reserve(used_.size());
    for (const std::uint32_t v : used_) values.push_back(value(v));
    return glb_.add_accessor(std::span(std::as_const(values)), component, type, GltfTarget::vertices);
  }

  void add_vertices() {
    std::vector<Vec3f> positions;
    for (const std::uint32_t v : used_) positions.push_back(cell_.positions[v]);
    attributes_["POSITION"] = glb_.add_positions(positions);
    attributes_["NORMAL"] =
        add_values([&](std::uint32_t v) { return unpack_normal(cell_.normals[v]); }, GltfComponent::floats, "VEC3");
    if (atlas_ || hierarchy_.attributes.uv)
      attributes_["TEXCOORD_0"] =
          add_values([&](std::uint32_t v) { return atlas_ ? atlas_->uv[v] : cell_.attributes.uv[v]; },
                     GltfComponent::floats, "VEC2");
    if (hierarchy_.attributes.colours) attributes_["COLOR_0"] = add_colours(cell_, {});
    if (!morph_) return;
    const Cell& parent = hierarchy_.cells[cell_.parent];
    attributes_["_PARENT"] =
        add_values([&](std::uint32_t v) { return parent.positions[cell_.parents[v]]; }, GltfComponent::floats, "VEC3");
    attributes_["_PARENTNORMAL"] =
        add_values([&](std::uint32_t v) { return unpack_normal(parent.normals[cell_.parents[v]]); },
                   GltfComponent::floats, "VEC3");
    if (atlas_ || hierarchy_.attributes.uv)
      attributes_["_PARENTTEXCOORD"] = add_values(
          [&](std::uint32_t v) { return atlas_ ? atlas_->parent_uv[v] : parent.attributes.uv[cell_.parents[v]]; },
          GltfComponent::floats, "VEC2");
    if (hierarchy_.attributes.colours) attributes_["_PARENTCOLOR"] = add_colours(parent, cell_.parents);
  }

  // `there`: vertices of `from` by vertex of this cell; empty: the same.
  std::size_t add_colours(const Cell& from, const Indices& there) {
    const std::size_t at = add_values(
        [&](std::uint32_t v) { return linear_colour(from.attributes.colours[there.empty() ? v : there[v]]); },
        GltfComponent::unsigned_short, "VEC4");
    glb_.root["accessors"][at]["normalized"] = true;
    return at;
  }

  // Materials of the atlas are numbered after those of the hierarchy.
  [[nodiscard]] std::uint32_t shown_material(const Triangle& t) const {
    const std::uint32_t material = material_of(hierarchy_, cell_, t.v[0]);
    const auto replacing = atlas_ ? atlas_->replacing(material) : std::nullopt;
    return replacing ? static_cast<std::uint32_t>(hierarchy_.materials.size()) + *replacing : material;
  }

  void add_primitives() {
    std::map<std::uint32_t, std::vector<std::uint32_t>> by_material;
    for (const Triangle& t : cell_.triangles) {
      std::vector<std::uint32_t>& ids = by_material[shown_material(t)];
      for (const std::uint32_t v : t.v) ids.push_back(number_[v]);
    }
    for (const auto& [material, ids] : by_material) {
      Json primitive{{"attributes", attributes_}, {"indices", glb_.add_indices(ids, used_.size())}};
      if (material != no_material) {
        primitive["material"] = materials_.size();
        materials_.push_back(material);
      }
      glb_.root["meshes"][0]["primitives"].push_back(std::move(primitive));
    }
  }

  void add_materials() {
    const auto count = static_cast<std::uint32_t>(hierarchy_.materials.size());
    std::map<std::uint32_t, std::uint32_t> textures, images;  // of the hierarchy, of the atlas -> of the file
    std::uint32_t in_file = 0;
    const auto local = [&](std::uint32_t texture) {
      if (texture >= hierarchy_.textures.size()) return no_texture;
      const auto [at, fresh] = textures.emplace(texture, in_file);
      if (fresh) glb_.add_linked_texture(hierarchy_.textures[texture], config_.texture_uri(texture)), ++in_file;
      return at->second;
    };
    const auto local_image = [&](std::uint32_t image) {
      if (image == no_texture) return no_texture;
      const auto [at, fresh] = images.emplace(image, in_file);
      if (fresh) glb_.add_linked_texture(atlas_->images[image], config_.atlas_uri(image)), ++in_file;
      return at->second;
    };
    for (const std::uint32_t m : materials_) {
      Material material = m < count ? hierarchy_.materials[m] : atlas_->materials[m - count];
      for_each_texture(material,
                       [&](std::uint32_t& texture) { texture = m < count ? local(texture) : local_image(texture); });
      glb_.add_material(material, in_file);
    }
    glb_.complete_materials();
  }

  const Hierarchy& hierarchy_;
  CellId id_;
  const Cell& cell_;
  const CellGlbConfig& config_;
  const TileAtlas* atlas_;
  bool morph_;
  std::span<const std::uint8_t> places_;  // by shared vertex
  GlbBuilder glb_;
  Json attributes_;
  std::vector<std::uint32_t> number_, used_;  // of the cell's vertices in the file, and the other way
  std::vector<std::uint32_t> materials_;      // of the hierarchy, by number in the file
};

}  // namespace

std::vector<std::byte> encode_cell_glb(const Hierarchy& hierarchy, CellId cell, const CellGlbConfig& config) {
  return CellEncoder(hierarchy, cell, config).encode();
}

}  // namespace lodestone
