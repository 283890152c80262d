#include "core/hierarchy/tiles/tile_atlas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <string>

#include "core/base/disjoint_sets.h"
#include "core/texture/colour.h"
#include "core/texture/page_packer.h"
#include "core/texture/texel_wrap.h"

namespace lodestone {
namespace {

// The maps of a material, in the order of for_each_texture().
enum Map : std::size_t { colours, normals, metal_and_roughness, occlusion, emission, map_count };

std::array<std::uint32_t, map_count> maps_of(const Material& m) {
  return {m.texture, m.normal_map, m.metallic_roughness.texture, m.occlusion.texture, m.emissive_map.texture};
}

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
  for (std::size_t map = normals; map < map_count; ++map)
    if (maps_of(m)[map] != no_texture) set_map(m, map, 0);
  return m;
}

// Half-open, in texels of the largest of a material's maps; may lie outside of it.
struct TexelBox {
  std::int64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  [[nodiscard]] std::int64_t width() const { return x1 - x0; }
  [[nodiscard]] std::int64_t height() const { return y1 - y0; }
  void include(const TexelBox& other) {
    x0 = std::min(x0, other.x0), y0 = std::min(y0, other.y0);
    x1 = std::max(x1, other.x1), y1 = std::max(y1, other.y1);
  }
};

// All that the tile shows of a material.
struct Use {
  std::uint32_t material = 0;
  std::array<std::shared_ptr<const PixelImage>, map_count> maps;
  PixelSize size{};  // of the texels below
  TextureWrap wrap_u{}, wrap_v{};
  std::vector<std::uint32_t> vertices;
  std::vector<std::uint32_t> part_of;              // by vertex above
  std::vector<std::array<std::int64_t, 2>> shift;  // by vertex above: whole repetitions to be subtracted
  std::vector<TexelBox> parts;
  std::vector<PagePlace> places;  // of parts, with their gutters
};

constexpr std::uint32_t gutter = 8;  // texels on each side; places are multiples of it
constexpr std::int64_t most_repetitions = 2;
constexpr std::uint32_t plain_side = 8;  // of the part of a material without textures

std::uint32_t padded(std::int64_t side) {
  return (static_cast<std::uint32_t>(side) + 2 * gutter + gutter - 1) / gutter * gutter;
}

bool overlap(const TexelBox& a, const TexelBox& b) {
  constexpr auto room = std::int64_t{2} * gutter;  // closer parts take less room as one
  return a.x0 < b.x1 + room && b.x0 < a.x1 + room && a.y0 < b.y1 + room && b.y0 < a.y1 + room;
}

// The pixel at (x, y), texel centres being at halves; interpolated where the image has another resolution.
std::array<float, 4> pixel_at(const PixelImage& image, const Use& use, double x, double y) {
  const double column = x * image.size.width / use.size.width - 0.5,
               row = y * image.size.height / use.size.height - 0.5;
  const double left = std::floor(column), top = std::floor(row), across = column - left, down = row - top;
  std::array<float, 4> sum{0, 0, 0, 0};
  for (const int j : {0, 1})
    for (const int i : {0, 1}) {
      const double weight = (i ? across : 1 - across) * (j ? down : 1 - down);
      if (weight == 0) continue;
      const std::size_t at =
          std::size_t{wrapped(static_cast<std::int64_t>(top) + j, image.size.height, use.wrap_v)} * image.size.width +
          wrapped(static_cast<std::int64_t>(left) + i, image.size.width, use.wrap_u);
      const std::uint8_t* p = &image.pixels[at * image.channels];
      for (std::size_t c = 0; c < 4; ++c) {
        const float value = c == 3 ? (image.channels == 4 ? p[3] : 255.0f) : p[image.channels == 1 ? 0 : c];
        sum[c] += static_cast<float>(weight) * value;
      }
    }
  return sum;
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
      use.parts = {{0, 0, plain_side, plain_side}};
      return true;
    }
    use.wrap_u = first->wrap_u, use.wrap_v = first->wrap_v;
    if (find_parts(use)) return true;
    ++atlas_.repeating;
    return false;
  }

  // Boxes around the charts, those that overlap as one. False if a chart covers too much of the plane.
  bool find_parts(Use& use) {
    DisjointSets charts(cell_.positions.size());
    for (const Triangle& t : cell_.triangles) {
      if (cell_.attributes.materials[t.v[0]] != use.material) continue;
      charts.unite(t.v[0], t.v[1]);
      charts.unite(t.v[0], t.v[2]);
    }
    struct Extent {
      double u0 = 1e30, v0 = 1e30, u1 = -1e30, v1 = -1e30;
      void include(Vec2f uv) {
        u0 = std::fmin(u0, uv.x), u1 = std::fmax(u1, uv.x);
        v0 = std::fmin(v0, uv.y), v1 = std::fmax(v1, uv.y);
      }
    };
    std::map<std::uint32_t, Extent> extents;
    for (const std::uint32_t v : use.vertices) {
      Extent& e = extents[charts.find(v)];
      e.include(cell_.attributes.uv[v]);
      if (parent_) e.include(parent_uv(v));  // of the same chart
    }
    std::map<std::uint32_t, std::array<std::int64_t, 2>> shifts;
    std::map<std::uint32_t, std::uint32_t> part_of;
    for (const auto& [chart, e] : extents) {
      if (!(e.u1 - e.u0 <= most_repetitions && e.v1 - e.v0 <= most_repetitions)) return false;
      if (!(std::abs(e.u0) < 1e6 && std::abs(e.v0) < 1e6)) return false;
      const auto shift = [](double from, TextureWrap wrap) {
        if (wrap == TextureWrap::clamp) return std::int64_t{0};
        const std::int64_t period = wrap == TextureWrap::mirror ? 2 : 1;
        return period * static_cast<std::int64_t>(std::floor(from / static_cast<double>(period)));
      };
      const auto [du, dv] = shifts[chart] = {shift(e.u0, use.wrap_u), shift(e.v0, use.wrap_v)};
      const auto texel = [](double t, std::int64_t moved, std::uint32_t size) {
        return static_cast<std::int64_t>(std::floor((t - static_cast<double>(moved)) * size));
      };
      part_of[chart] = static_cast<std::uint32_t>(use.parts.size());
      use.parts.push_back({texel(e.u0, du, use.size.width), texel(e.v0, dv, use.size.height),
                           texel(e.u1, du, use.size.width) + 1, texel(e.v1, dv, use.size.height) + 1});
    }
    const std::vector<std::uint32_t> merged = merge(use.parts);
    for (const std::uint32_t v : use.vertices) {
      const std::uint32_t chart = charts.find(v);
      use.shift.push_back(shifts[chart]);
      use.part_of.push_back(merged[part_of[chart]]);
    }
    return true;
  }

  // Unites boxes until none overlap, or takes one for all where that is no larger. Returns the new number of each.
  static std::vector<std::uint32_t> merge(std::vector<TexelBox>& parts) {
    DisjointSets sets(parts.size());
    std::vector<TexelBox> boxes = parts;
    for (bool changed = true; changed;) {
      changed = false;
      for (std::uint32_t a = 0; a < boxes.size(); ++a) {
        if (sets.find(a) != a) continue;
        for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
          if (sets.find(b) != b || !overlap(boxes[a], boxes[b])) continue;
          sets.unite(a, b);
          boxes[a].include(boxes[b]);
          changed = true;
        }
      }
    }
    const auto area = [](const TexelBox& box) { return std::uint64_t{padded(box.width())} * padded(box.height()); };
    TexelBox whole = boxes.front();
    std::uint64_t sum = 0;
    for (std::uint32_t a = 0; a < boxes.size(); ++a) {
      if (sets.find(a) != a) continue;
      whole.include(boxes[a]);
      sum += area(boxes[a]);
    }
    std::vector<std::uint32_t> number(parts.size(), 0);
    if (sum >= area(whole)) {
      parts = {whole};
      return number;
    }
    parts.clear();
    for (std::uint32_t a = 0; a < boxes.size(); ++a) {
      const std::uint32_t root = sets.find(a);
      if (root == a) {
        number[a] = static_cast<std::uint32_t>(parts.size());
        parts.push_back(boxes[a]);
      } else {
        number[a] = number[root];
      }
    }
    return number;
  }

  // An atlas for as many of the materials as have room in it, the largest left out first.
  void add_atlas(Material material, std::vector<Use*> uses) {
    PixelSize size;
    while (uses.size() > 1 && !pack(uses, size)) {
      const auto texels = [](const Use* use) {
        std::uint64_t sum = 0;
        for (const TexelBox& box : use->parts) sum += std::uint64_t{padded(box.width())} * padded(box.height());
        return sum;
      };
      uses.erase(std::ranges::max_element(uses, {}, texels));
    }
    if (uses.size() < 2) return;
    const Material& first = hierarchy_.materials[uses.front()->material];
    const bool same_colour = std::ranges::all_of(
        uses, [&](const Use* use) { return hierarchy_.materials[use->material].base_colour == first.base_colour; });
    if (same_colour) material.base_colour = first.base_colour;
    for (std::size_t map = 0; map < map_count; ++map) {
      if (std::ranges::none_of(uses,
                               [&](const Use* use) { return use->maps[map] || (map == colours && !same_colour); }))
        continue;
      set_map(material, map, static_cast<std::uint32_t>(atlas_.images.size()));
      atlas_.images.push_back(encode(uses, map, size, !same_colour));
    }
    const auto number = static_cast<std::uint32_t>(atlas_.materials.size());
    atlas_.materials.push_back(std::move(material));
    for (const Use* use : uses) {
      atlas_.replaced_by[use->material] = number;
      place_vertices(*use, size);
    }
  }

  // False if they do not fit.
  bool pack(const std::vector<Use*>& uses, PixelSize& size) const {
    struct Part {
      Use* use;
      std::size_t number;
      PixelSize size;
    };
    std::vector<Part> parts;
    double texels = 0;
    std::uint32_t widest = 0;
    for (Use* use : uses) {
      use->places.resize(use->parts.size());
      for (std::size_t k = 0; k < use->parts.size(); ++k) {
        const PixelSize p{padded(use->parts[k].width()), padded(use->parts[k].height())};
        parts.push_back({use, k, p});
        texels += double{1} * p.width * p.height;
        widest = std::max(widest, p.width);
      }
    }
    std::ranges::stable_sort(parts, std::greater{}, [](const Part& p) { return p.size.height; });
    const auto square = static_cast<std::uint32_t>(std::ceil(std::sqrt(texels) / gutter)) * gutter;
    const std::uint32_t longest = config_.longest_side;
    if (std::max(widest, square) > longest || parts.front().size.height > longest) return false;
    // About a square first; where its shelves waste too much, as wide as it may be.
    const auto fit = [&](std::uint32_t width) {
      PagePacker packer({width, longest});
      size = {width, 0};
      for (const Part& part : parts) {
        const PagePlace at = packer.add(part.size);
        if (at.page > 0) return false;
        part.use->places[part.number] = at;
        size.height = std::max(size.height, at.y + part.size.height);
      }
      return true;
    };
    return fit(std::max(widest, square)) || fit(longest / gutter * gutter);
  }

  void place_vertices(const Use& use, PixelSize size) {
    if (atlas_.uv.empty()) {
      atlas_.uv.assign(cell_.positions.size(), {});
      if (hierarchy_.attributes.uv) std::ranges::copy(cell_.attributes.uv, atlas_.uv.begin());
      if (parent_) atlas_.parent_uv = atlas_.uv;
      for (std::uint32_t v = 0; parent_ && hierarchy_.attributes.uv && v < atlas_.uv.size(); ++v)
        atlas_.parent_uv[v] = parent_uv(v);
    }
    for (std::size_t k = 0; k < use.vertices.size(); ++k) {
      const std::uint32_t v = use.vertices[k];
      atlas_.uv[v] = placed(use, k, size, atlas_.uv[v]);
      if (parent_) atlas_.parent_uv[v] = placed(use, k, size, atlas_.parent_uv[v]);
    }
  }

  [[nodiscard]] Vec2f parent_uv(std::uint32_t v) const { return parent_->attributes.uv[cell_.parents[v]]; }

  // The place in the atlas of a coordinate of vertex k of a use.
  static Vec2f placed(const Use& use, std::size_t k, PixelSize size, Vec2f uv) {
    const std::size_t part = use.part_of.empty() ? 0 : use.part_of[k];
    const TexelBox& box = use.parts[part];
    const PagePlace& at = use.places[part];
    if (use.part_of.empty())
      return {static_cast<float>((at.x + gutter + plain_side / 2.0) / size.width),
              static_cast<float>((at.y + gutter + plain_side / 2.0) / size.height)};
    const auto along = [](double t, std::int64_t shift, std::uint32_t texels, std::int64_t first, std::uint32_t to,
                          std::uint32_t side) {
      const double texel = (t - static_cast<double>(shift)) * texels - static_cast<double>(first);
      return static_cast<float>((texel + to + gutter) / side);
    };
    return {along(uv.x, use.shift[k][0], use.size.width, box.x0, at.x, size.width),
            along(uv.y, use.shift[k][1], use.size.height, box.y0, at.y, size.height)};
  }

  Texture encode(const std::vector<Use*>& uses, std::size_t map, PixelSize size, bool bakes_colour) const {
    const Material& first = hierarchy_.materials[uses.front()->material];
    const bool alpha = map == colours && first.alpha_mode != AlphaMode::opaque;
    PixelImage image{.size = size, .channels = alpha ? 4u : 3u, .pixels = {}};
    image.pixels.assign(std::size_t{size.width} * size.height * image.channels, 0);
    std::vector<bool> painted(std::size_t{size.width} * size.height);
    for (const Use* use : uses)
      for (std::size_t part = 0; part < use->parts.size(); ++part)
        paint(*use, part, map, bakes_colour && map == colours, image, painted);
    fill_rest(painted, image);
    Texture texture;
    texture.media_type = media_type_for(uses, map, alpha);
    texture.wrap_u = texture.wrap_v = TextureWrap::clamp;
    texture.bytes = encode_image(image, texture.media_type);
    return texture;
  }

  void paint(const Use& use, std::size_t part, std::size_t map, bool bakes_colour, PixelImage& image,
             std::vector<bool>& painted) const {
    const TexelBox& box = use.parts[part];
    const PagePlace& at = use.places[part];
    const std::array<float, 4> factor = hierarchy_.materials[use.material].base_colour;
    const std::uint32_t width = padded(box.width()), height = padded(box.height());
    for (std::uint32_t y = 0; y < height; ++y)
      for (std::uint32_t x = 0; x < width; ++x) {
        const double u = static_cast<double>(box.x0) - gutter + x + 0.5,
                     v = static_cast<double>(box.y0) - gutter + y + 0.5;
        std::array<float, 4> value{255, 255, 255, 255};
        if (use.maps[map]) value = pixel_at(*use.maps[map], use, u, v);
        if (bakes_colour)
          for (std::size_t c = 0; c < 4; ++c) value[c] = times(value[c], factor[c], c == 3);
        const std::size_t pixel = std::size_t{at.y + y} * image.size.width + at.x + x;
        painted[pixel] = true;
        for (std::size_t c = 0; c < image.channels; ++c)
          image.pixels[pixel * image.channels + c] = static_cast<std::uint8_t>(std::lround(value[c]));
      }
  }

  // A byte of a colour times a factor of its light.
  static float times(float byte, float factor, bool is_alpha) {
    if (factor == 1) return byte;
    if (is_alpha) return byte * factor;
    const double encoded = double{byte} / 255;
    const double light = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
    return static_cast<float>(std::clamp(255 * linear_to_srgb(light * factor), 0.0, 255.0));
  }

  // The mean colour where no part is: small mip levels show a little of it.
  static void fill_rest(const std::vector<bool>& painted, PixelImage& image) {
    std::array<std::uint64_t, 4> sum{};
    std::uint64_t count = 0;
    for (std::size_t p = 0; p < painted.size(); ++p) {
      if (!painted[p]) continue;
      ++count;
      for (std::size_t c = 0; c < image.channels; ++c) sum[c] += image.pixels[p * image.channels + c];
    }
    for (std::size_t p = 0; p < painted.size(); ++p)
      for (std::size_t c = 0; !painted[p] && c < image.channels; ++c)
        image.pixels[p * image.channels + c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
  }

  // That of the sources if they agree; else one that loses nothing that any of them has.
  [[nodiscard]] std::string media_type_for(const std::vector<Use*>& uses, std::size_t map, bool alpha) const {
    std::string type;
    for (const Use* use : uses) {
      const std::uint32_t texture = maps_of(hierarchy_.materials[use->material])[map];
      if (texture == no_texture) continue;
      const std::string& own = hierarchy_.textures[texture].media_type;
      if (!type.empty() && type != own) return "image/png";
      type = own;
    }
    return type.empty() || (alpha && type == "image/jpeg") ? "image/png" : type;
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
