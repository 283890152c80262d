#include "core/hierarchy/lode/lode_assets.h"

#include <cmath>
#include <cstring>
#include <string>

namespace lodestone {
namespace {

class Writer {
 public:
  template <class T>
  void put(const T& value) {
    append(&value, sizeof(value));
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    append(text.data(), text.size());
  }
  void put(const std::vector<char>& content) {
    put(static_cast<std::uint64_t>(content.size()));
    append(content.data(), content.size());
  }
  std::vector<std::byte> bytes;

 private:
  void append(const void* from, std::size_t count) {
    const auto* const first = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), first, first + count);
  }
};

// Every read says whether the bytes were there; nothing is allocated for more than is there.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}
  template <class T>
  bool take(T& value) {
    return copy(&value, sizeof(value));
  }
  bool take(std::string& text) {
    std::uint32_t size = 0;
    if (!take(size) || size > rest_.size()) return false;
    text.resize(size);
    return copy(text.data(), size);
  }
  bool take(std::vector<char>& content) {
    std::uint64_t size = 0;
    if (!take(size) || size > rest_.size()) return false;
    content.resize(size);
    return copy(content.data(), size);
  }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  bool copy(void* to, std::size_t count) {
    if (count > rest_.size()) return false;
    if (count > 0) std::memcpy(to, rest_.data(), count);
    rest_ = rest_.subspan(count);
    return true;
  }
  std::span<const std::byte> rest_;
};

void put(Writer& writer, const Material& m) {
  writer.put(m.name);
  for (const float channel : m.base_colour) writer.put(channel);
  writer.put(m.texture);
  writer.put(m.normal_map);
}

void put(Writer& writer, const Texture& t) {
  writer.put(t.name);
  writer.put(t.media_type);
  writer.put(static_cast<std::uint8_t>(t.wrap_u));
  writer.put(static_cast<std::uint8_t>(t.wrap_v));
  writer.put(std::uint16_t{0});
  writer.put(t.bytes);
}

bool take(Reader& reader, Material& m) {
  bool there = reader.take(m.name);
  for (float& channel : m.base_colour) there = there && reader.take(channel) && std::isfinite(channel);
  return there && reader.take(m.texture) && reader.take(m.normal_map);
}

bool take(Reader& reader, Texture& t) {
  constexpr auto last = static_cast<std::uint8_t>(TextureWrap::mirror);
  std::uint8_t u = 0, v = 0;
  std::uint16_t zero = 0;
  if (!reader.take(t.name) || !reader.take(t.media_type) || !reader.take(u) || !reader.take(v) || !reader.take(zero))
    return false;
  if (u > last || v > last || zero != 0) return false;
  t.wrap_u = static_cast<TextureWrap>(u);
  t.wrap_v = static_cast<TextureWrap>(v);
  return reader.take(t.bytes);
}

void put(Writer& writer, const TextureCopy& c) {
  for (const std::uint32_t number : {c.texture, c.halvings, c.width, c.height}) writer.put(number);
  writer.put(c.bytes);
}

bool take(Reader& reader, TextureCopy& c) {
  return reader.take(c.texture) && reader.take(c.halvings) && reader.take(c.width) && reader.take(c.height) &&
         reader.take(c.bytes);
}

// By texture, then 1, 2, ... halvings.
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

// No record is smaller than this.
constexpr std::size_t least_record = 20;

template <class T>
bool take_all(Reader& reader, std::vector<T>& items) {
  std::uint32_t count = 0;
  if (!reader.take(count) || count > reader.left() / least_record) return false;
  items.resize(count);
  for (T& item : items)
    if (!take(reader, item)) return false;
  return true;
}

}  // namespace

std::vector<std::byte> encode_assets(const Hierarchy& hierarchy) {
  if (hierarchy.materials.empty() && hierarchy.textures.empty()) return {};
  Writer writer;
  writer.put(static_cast<std::uint32_t>(hierarchy.materials.size()));
  for (const Material& m : hierarchy.materials) put(writer, m);
  writer.put(static_cast<std::uint32_t>(hierarchy.textures.size()));
  for (const Texture& t : hierarchy.textures) put(writer, t);
  if (!hierarchy.texture_copies.empty()) {
    writer.put(static_cast<std::uint32_t>(hierarchy.texture_copies.size()));
    for (const TextureCopy& c : hierarchy.texture_copies) put(writer, c);
  }
  return std::move(writer.bytes);
}

const char* decode_assets(std::span<const std::byte> bytes, bool has_copies, Hierarchy& hierarchy) {
  if (bytes.empty()) return has_copies ? "copies of textures, but no textures" : nullptr;
  Reader reader(bytes);
  if (!take_all(reader, hierarchy.materials)) return "the materials are not what they should be";
  if (!take_all(reader, hierarchy.textures)) return "the textures are not what they should be";
  if (has_copies &&
      (!take_all(reader, hierarchy.texture_copies) || !in_order(hierarchy.texture_copies, hierarchy.textures.size())))
    return "the copies of textures are not what they should be";
  if (reader.left() != 0) return "materials and textures go on beyond their end";
  for (const Material& m : hierarchy.materials)
    for (const std::uint32_t texture : {m.texture, m.normal_map})
      if (texture != no_texture && texture >= hierarchy.textures.size()) return "a material has no such texture";
  return nullptr;
}

}  // namespace lodestone
