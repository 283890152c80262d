#include "core/io/glb_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/error.h"

namespace lodestone {
namespace {

using nlohmann::json;

// Numbers of the glTF specification.
enum Component : int { unsigned_byte = 5121, unsigned_int = 5125, floats = 5126 };
enum Target : int { vertices = 34962, indices = 34963 };

class GlbEncoder {
 public:
  explicit GlbEncoder(const MeshView& mesh) : mesh_(mesh) {}

  std::vector<std::byte> encode() {
    place_node();
    add_vertices();
    add_primitives();
    add_materials();
    add_textures();
    return container();
  }

 private:
  void place_node() {
    const auto [lo, hi] = box_of(mesh_);
    middle_ = 0.5 * (lo + hi);
    root_["asset"] = {{"version", "2.0"}, {"generator", "Lodestone"}};
    root_["scene"] = 0;
    root_["scenes"] = {{{"nodes", {0}}}};
    root_["nodes"] = {{{"mesh", 0}, {"translation", {middle_.x, middle_.y, middle_.z}}}};
  }

  // Bytes of a buffer view, at a multiple of four; returns its number.
  std::size_t add_view(const void* data, std::size_t bytes, int target) {
    const std::size_t offset = binary_.size();
    binary_.resize(offset + (bytes + 3) / 4 * 4);
    if (bytes > 0) std::memcpy(binary_.data() + offset, data, bytes);
    json view{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}};
    if (target != 0) view["target"] = target;
    root_["bufferViews"].push_back(std::move(view));
    return root_["bufferViews"].size() - 1;
  }
  template <class T>
  std::size_t add_accessor(const std::vector<T>& items, Component component, const char* type, int target,
                           std::size_t count) {
    root_["accessors"].push_back({{"bufferView", add_view(items.data(), items.size() * sizeof(T), target)},
                                  {"componentType", static_cast<int>(component)},
                                  {"count", count},
                                  {"type", type}});
    return root_["accessors"].size() - 1;
  }

  void add_vertices() {
    std::vector<Vec3f> positions(mesh_.vertex_count);
    constexpr float far = std::numeric_limits<float>::max();
    Vec3f lo{far, far, far}, hi{-far, -far, -far};
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Vec3f p = positions[i] = to_float(mesh_.position(i) - middle_);
      lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
      hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    const std::size_t at = add_accessor(positions, floats, "VEC3", vertices, positions.size());
    root_["accessors"][at]["min"] = {lo.x, lo.y, lo.z};
    root_["accessors"][at]["max"] = {hi.x, hi.y, hi.z};
    attributes_["POSITION"] = at;
    if (mesh_.wedges == nullptr) return;
    const RawWedges& w = *mesh_.wedges;
    if (!w.normal.empty()) attributes_["NORMAL"] = add_accessor(w.normal, floats, "VEC3", vertices, w.normal.size());
    if (!w.uv.empty()) attributes_["TEXCOORD_0"] = add_accessor(w.uv, floats, "VEC2", vertices, w.uv.size());
    if (!w.colour.empty()) add_colours(w.colour);
  }

  // Colours are sRGB in files of meshes and linear in glTF.
  void add_colours(const std::vector<Rgba8>& colours) {
    std::array<float, 256> linear{};
    for (std::size_t i = 0; i < linear.size(); ++i) {
      const float c = static_cast<float>(i) / 255;
      linear[i] = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
    }
    std::vector<std::array<float, 4>> out(colours.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Rgba8 c = colours[i];
      out[i] = {linear[c.r], linear[c.g], linear[c.b], static_cast<float>(c.a) / 255};
    }
    attributes_["COLOR_0"] = add_accessor(out, floats, "VEC4", vertices, out.size());
  }

  void add_primitives() {
    std::map<std::uint32_t, std::vector<std::uint32_t>> by_material;
    const bool has_materials = mesh_.wedges != nullptr && !mesh_.wedges->material.empty();
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      std::vector<std::uint32_t>& ids = by_material[has_materials ? mesh_.wedges->material[t] : no_material];
      ids.insert(ids.end(), mesh_.triangles[t].v.begin(), mesh_.triangles[t].v.end());
    }
    for (const auto& [material, ids] : by_material) {
      json primitive{{"attributes", attributes_},
                     {"indices", add_accessor(ids, unsigned_int, "SCALAR", indices, ids.size())}};
      if (material < mesh_.materials.size()) primitive["material"] = material;
      root_["meshes"][0]["primitives"].push_back(std::move(primitive));
    }
  }

  void add_materials() {
    for (const Material& m : mesh_.materials) {
      json pbr{{"baseColorFactor", m.base_colour}, {"metallicFactor", 0}};
      if (m.texture < mesh_.textures.size()) pbr["baseColorTexture"] = {{"index", m.texture}};
      json material{{"pbrMetallicRoughness", std::move(pbr)}};
      if (!m.name.empty()) material["name"] = m.name;
      if (m.normal_map < mesh_.textures.size()) material["normalTexture"] = {{"index", m.normal_map}};
      root_["materials"].push_back(std::move(material));
    }
  }

  void add_textures() {
    constexpr std::array wraps{10497, 33071, 33648};  // REPEAT, CLAMP_TO_EDGE, MIRRORED_REPEAT
    std::set<std::string> extensions;
    for (std::size_t i = 0; i < mesh_.textures.size(); ++i) {
      const Texture& t = mesh_.textures[i];
      root_["samplers"].push_back(
          {{"wrapS", wraps[static_cast<std::size_t>(t.wrap_u)]}, {"wrapT", wraps[static_cast<std::size_t>(t.wrap_v)]}});
      json image{{"bufferView", add_view(t.bytes.data(), t.bytes.size(), 0)}, {"mimeType", t.media_type}};
      if (!t.name.empty()) image["name"] = t.name;
      root_["images"].push_back(std::move(image));
      json texture{{"sampler", i}};
      const char* extension = t.media_type == "image/webp"   ? "EXT_texture_webp"
                              : t.media_type == "image/ktx2" ? "KHR_texture_basisu"
                                                             : nullptr;
      if (extension == nullptr) {
        texture["source"] = i;
      } else {
        texture["extensions"][extension]["source"] = i;
        extensions.insert(extension);
      }
      root_["textures"].push_back(std::move(texture));
    }
    for (const std::string& e : extensions) {
      root_["extensionsUsed"].push_back(e);
      root_["extensionsRequired"].push_back(e);
    }
  }

  // Header, JSON padded with spaces, binary chunk padded with zeros (12.3.3 and 4.4 of the specification).
  std::vector<std::byte> container() {
    root_["buffers"] = {{{"byteLength", binary_.size()}}};
    std::string text = root_.dump(-1, ' ', false, json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t total = 12 + 8 + text.size() + 8 + binary_.size();
    if (total > std::numeric_limits<std::uint32_t>::max())
      throw ResourceError(describe("", "", "more than 4 GiB, which a .glb file cannot hold", "export a coarser level"));
    const auto word = [](std::uint64_t v) { return static_cast<std::uint32_t>(v); };
    const std::array<std::uint32_t, 5> head{0x46546c67u, 2, word(total), word(text.size()), 0x4e4f534au};
    const std::array<std::uint32_t, 2> chunk{word(binary_.size()), 0x004e4942u};
    std::vector<std::byte> out(total);
    std::byte* to = out.data();
    const auto append = [&](std::span<const std::byte> bytes) { to = std::copy(bytes.begin(), bytes.end(), to); };
    append(std::as_bytes(std::span(head)));
    append(std::as_bytes(std::span(text)));
    append(std::as_bytes(std::span(chunk)));
    append(binary_);
    return out;
  }

  const MeshView& mesh_;
  Vec3d middle_;
  json root_, attributes_;
  std::vector<std::byte> binary_;
};

}  // namespace

std::vector<std::byte> encode_glb(const MeshView& mesh) { return GlbEncoder(mesh).encode(); }

void write_glb(AtomicFile& file, const MeshView& mesh) { file.write(encode_glb(mesh)); }

}  // namespace lodestone
