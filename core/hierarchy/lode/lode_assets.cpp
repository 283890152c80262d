// Signatures, materials and textures of a .lode file (lode_format.h describes their bytes).
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/base/registry.h"
#include "core/formats/gltf/gltf_surface.h"
#include "core/hierarchy/lode/lode_format.h"

namespace lodestone {
namespace {

// Both archives are called with the fields of a record in order: one writes them, the other reads them.
class Writer {
 public:
  template <class T>
  bool operator()(const T& value) {
    append(&value, sizeof(value));
    return true;
  }
  bool operator()(const std::string& text) {
    (*this)(static_cast<std::uint32_t>(text.size()));
    append(text.data(), text.size());
    return true;
  }
  bool operator()(const std::vector<char>& content) {
    (*this)(static_cast<std::uint64_t>(content.size()));
    items(content);
    return true;
  }
  template <class T>
  void items(const std::vector<T>& all) {
    append(all.data(), all.size() * sizeof(T));
  }
  std::vector<std::byte> bytes;

 private:
  void append(const void* from, std::size_t count) {
    const auto* const first = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), first, first + count);
  }
};

// Every call returns false if the bytes end before or are invalid; no memory is allocated for more than the bytes can
// hold.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}
  template <class T>
  bool operator()(T& value) {
    return copy(&value, sizeof(value));
  }
  bool operator()(float& value) { return copy(&value, sizeof(value)) && std::isfinite(value); }
  bool operator()(TextureWrap& wrap) { return copy(&wrap, sizeof(wrap)) && wrap <= TextureWrap::mirror; }
  bool operator()(const std::uint16_t& zero) {
    std::uint16_t value = 1;
    return copy(&value, sizeof(value)) && value == zero;
  }
  bool operator()(std::string& text) { return take_sized<std::uint32_t>(text); }
  bool operator()(std::vector<char>& content) { return take_sized<std::uint64_t>(content); }
  template <class T>
  bool items(std::vector<T>& all, std::uint64_t count) {
    if (count > rest_.size() / sizeof(T)) return false;
    all.resize(count);
    return copy(all.data(), count * sizeof(T));
  }
  // The reader of the next bytes, which are left out here; an empty one beyond the end.
  Reader part(std::uint64_t bytes) {
    const Reader part(rest_.first(std::min<std::uint64_t>(bytes, rest_.size())));
    rest_ = rest_.subspan(part.left());
    return part;
  }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  template <class Size, class Items>
  bool take_sized(Items& items) {
    Size size = 0;
    if (!(*this)(size) || size > rest_.size()) return false;
    items.resize(size);
    return copy(items.data(), size);
  }
  bool copy(void* to, std::size_t count) {
    if (count > rest_.size()) return false;
    if (count > 0) std::memcpy(to, rest_.data(), count);
    rest_ = rest_.subspan(count);
    return true;
  }
  std::span<const std::byte> rest_;
};

// The records; items are const for a Writer.
constexpr auto each_material = [](auto& archive, auto& m) {
  return archive(m.name) && archive(m.base_colour[0]) && archive(m.base_colour[1]) && archive(m.base_colour[2]) &&
         archive(m.base_colour[3]) && archive(m.texture) && archive(m.normal_map);
};

constexpr auto each_texture = [](auto& archive, auto& t) {
  constexpr std::uint16_t zero = 0;
  return archive(t.name) && archive(t.media_type) && archive(t.wrap_u) && archive(t.wrap_v) && archive(zero) &&
         archive(t.bytes);
};

constexpr auto each_copy = [](auto& archive, auto& c) {
  return archive(c.texture) && archive(c.halvings) && archive(c.width) && archive(c.height) && archive(c.bytes);
};

// True if copies are sorted by texture, then by 1, 2, ... halvings.
bool in_order(const std::vector<TextureCopy>& copies, std::size_t textures) {
  for (std::size_t i = 0; i < copies.size(); ++i) {
    const TextureCopy& c = copies[i];
    if (c.texture >= textures || c.width == 0 || c.height == 0) return false;
    const bool goes_on = i > 0 && copies[i - 1].texture == c.texture;
    if (c.halvings != (goes_on ? copies[i - 1].halvings + 1 : 1)) return false;
    if (i > 0 && copies[i - 1].texture > c.texture) return false;
  }
  return true;
}

// Minimum size of a record.
constexpr std::size_t min_record = 20;

template <class T, class Visit>
bool take_all(Reader& reader, std::vector<T>& items, const Visit& visit) {
  std::uint32_t count = 0;
  if (!reader(count) || count > reader.left() / min_record) return false;
  items.resize(count);
  return std::all_of(items.begin(), items.end(), [&](T& item) { return visit(reader, item); });
}

template <class T, class Visit>
void put_all(Writer& writer, const std::vector<T>& items, const Visit& visit) {
  writer(static_cast<std::uint32_t>(items.size()));
  for (const T& item : items) visit(writer, item);
}

void put_signatures(Writer& writer, const Signatures::Table& table) {
  Writer all;
  all.items(table.sets), all.items(table.sizes), all.items(table.cells), all.items(table.errors),
      all.items(table.places);
  writer(static_cast<std::uint64_t>(all.bytes.size()));
  writer.items(all.bytes);
}

const char* take_signatures(Reader& reader, Hierarchy& hierarchy) {
  const auto sum = [](const std::vector<std::uint32_t>& items) {
    return std::reduce(items.begin(), items.end(), std::uint64_t{0});
  };
  std::uint64_t bytes = 0;
  if (!reader(bytes) || bytes > reader.left()) return "the signatures are invalid";
  Reader all = reader.part(bytes);
  Signatures::Table table;
  if (!all.items(table.sets, hierarchy.levels.size()) || !all.items(table.sizes, sum(table.sets)) ||
      !all.items(table.cells, sum(table.sizes)) || !all.items(table.errors, table.sizes.size()) ||
      !all.items(table.places, all.left()))
    return "the signatures are invalid";
  if (const char* fault = Signatures::fault(hierarchy, table)) return fault;
  hierarchy.signatures = std::make_shared<const Signatures>(hierarchy, std::move(table));
  return nullptr;
}

// A material with the fields of its record alone.
Material recorded(const Material& m) {
  return {.name = m.name, .base_colour = m.base_colour, .texture = m.texture, .normal_map = m.normal_map};
}

Json surfaces_of(const Hierarchy& hierarchy) {
  Json materials = Json::array(), samplers = Json::array();
  for (const Material& m : hierarchy.materials) materials.push_back(surface_json(m, hierarchy.textures.size()));
  for (const Texture& t : hierarchy.textures)
    samplers.push_back({{"magFilter", t.mag_filter}, {"minFilter", t.min_filter}});
  return {{"materials", std::move(materials)}, {"samplers", std::move(samplers)}};
}

// Throws InputError.
void read_surfaces(const JsonView& source, Hierarchy& hierarchy) {
  const JsonView materials = source.at("materials"), samplers = source.at("samplers");
  if (materials.size() != hierarchy.materials.size() || samplers.size() != hierarchy.textures.size())
    source.fail("other numbers of materials and textures");
  const ReadTexture texture = textures_of_mesh(hierarchy.textures.size());
  for (std::size_t k = 0; k < materials.size(); ++k) read_surface(materials.at(k), texture, hierarchy.materials[k]);
  for (std::size_t k = 0; k < samplers.size(); ++k) {
    const auto filter = [&](const char* key) {
      const std::uint64_t number = samplers.at(k).at(key).integer();
      if (!is_filter(number)) samplers.at(k).fail("unknown filter");
      return static_cast<std::uint16_t>(number);
    };
    hierarchy.textures[k].mag_filter = filter("magFilter");
    hierarchy.textures[k].min_filter = filter("minFilter");
  }
}

}  // namespace

bool has_named_simplifier(const Hierarchy& hierarchy) {
  return std::ranges::find(lode_simplifiers, hierarchy.provenance.simplifier) == lode_simplifiers.end();
}

bool has_surfaces(const Hierarchy& hierarchy) {
  return std::ranges::any_of(hierarchy.materials, [](const Material& m) { return m != recorded(m); }) ||
         std::ranges::any_of(hierarchy.textures,
                             [](const Texture& t) { return t.mag_filter != 0 || t.min_filter != 0; });
}

std::vector<std::byte> encode_assets(const Hierarchy& hierarchy, const Signatures::Table* signatures) {
  Writer writer;
  if (has_named_simplifier(hierarchy)) writer(hierarchy.provenance.simplifier);
  if (signatures) put_signatures(writer, *signatures);
  if (hierarchy.materials.empty() && hierarchy.textures.empty()) return std::move(writer.bytes);
  put_all(writer, hierarchy.materials, each_material);
  put_all(writer, hierarchy.textures, each_texture);
  if (!hierarchy.texture_copies.empty()) put_all(writer, hierarchy.texture_copies, each_copy);
  if (has_surfaces(hierarchy)) {
    const std::string text = surfaces_of(hierarchy).dump();
    writer(std::vector<char>(text.begin(), text.end()));
  }
  return std::move(writer.bytes);
}

const char* decode_assets(std::span<const std::byte> bytes, std::uint16_t features, Hierarchy& hierarchy) {
  const bool has_copies = features & lode_texture_copies;
  Reader reader(bytes);
  if (features & lode_named_simplifier &&
      !(reader(hierarchy.provenance.simplifier) && can_be_name(hierarchy.provenance.simplifier)))
    return "the name of the simplifier is invalid";
  if (features & lode_signatures)
    if (const char* fault = take_signatures(reader, hierarchy)) return fault;
  if (reader.left() == 0)
    return has_copies || features & lode_surfaces ? "there are copies of textures or surfaces, but no textures"
                                                  : nullptr;
  if (!take_all(reader, hierarchy.materials, each_material)) return "the materials are invalid";
  if (!take_all(reader, hierarchy.textures, each_texture)) return "the textures are invalid";
  if (has_copies && (!take_all(reader, hierarchy.texture_copies, each_copy) ||
                     !in_order(hierarchy.texture_copies, hierarchy.textures.size())))
    return "the copies of textures are invalid";
  std::vector<char> surfaces;
  if (features & lode_surfaces && !reader(surfaces)) return "the surfaces are invalid";
  if (reader.left() != 0) return "there are bytes after the materials and textures";
  for (const Material& m : hierarchy.materials)
    for (const std::uint32_t texture : {m.texture, m.normal_map})
      if (texture != no_texture && texture >= hierarchy.textures.size())
        return "the texture of a material does not exist";
  if (features & lode_surfaces) try {
      const std::string file;
      const Json root = parse_json(surfaces, file);
      read_surfaces({root, file}, hierarchy);
    } catch (const InputError&) {
      return "the surfaces are invalid";
    }
  return nullptr;
}

}  // namespace lodestone
