#include "core/formats/gltf/glb_builder.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/base/error.h"
#include "core/formats/gltf/gltf_meshopt.h"
#include "core/formats/gltf/gltf_surface.h"
#include "core/math/affine.h"
#include "core/mesh/up_axis.h"

namespace lodestone {
namespace {

// The extension that allows an image of this type; nullptr for PNG and JPEG, which need none.
const char* extension_for(const std::string& media_type) {
  if (media_type == "image/webp") return "EXT_texture_webp";
  return media_type == "image/ktx2" ? "KHR_texture_basisu" : nullptr;
}

void add_once(Json& names, const char* name) {
  if (std::find(names.begin(), names.end(), Json(name)) == names.end()) names.push_back(name);
}

// Header, JSON and binary chunk.
std::vector<std::byte> pack(const Json& root, std::span<const std::byte> binary) {
  std::string text = root.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::uint64_t total = 12 + 8 + text.size() + 8 + binary.size();
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw ResourceError(
        describe("", "", "the .glb file would exceed 4 GiB, which the format cannot hold", "export a coarser level"));
  const auto word = [](std::uint64_t v) { return static_cast<std::uint32_t>(v); };
  const std::array<std::uint32_t, 5> head{0x46546c67u, 2, word(total), word(text.size()), 0x4e4f534au};
  const std::array<std::uint32_t, 2> chunk{word(binary.size()), 0x004e4942u};
  std::vector<std::byte> out(total);
  std::byte* to = out.data();
  const auto append = [&](std::span<const std::byte> bytes) { to = std::copy(bytes.begin(), bytes.end(), to); };
  append(std::as_bytes(std::span(head)));
  append(std::as_bytes(std::span(text)));
  append(std::as_bytes(std::span(chunk)));
  append(binary);
  return out;
}

}  // namespace

void GlbBuilder::add_node(Vec3d place, double scale, UpAxis up) {
  const Vec3d from = direction_of(up, place), to = direction_of(UpAxis::y, {}),
              at = turn_between(from, to).vector(place);
  root["scene"] = 0;
  root["scenes"] = {{{"nodes", {0}}}};
  Json node{{"mesh", 0}, {"translation", {at.x, at.y, at.z}}};
  if (from != to) node["rotation"] = turn_quaternion(from, to);
  if (scale != 1) node["scale"] = {scale, scale, scale};
  root["nodes"] = Json::array({std::move(node)});
}

std::size_t GlbBuilder::add_view(std::span<const std::byte> bytes, GltfTarget target) {
  const std::size_t offset = binary_.size();
  binary_.resize(offset + (bytes.size() + 3) / 4 * 4);
  std::copy(bytes.begin(), bytes.end(), binary_.begin() + static_cast<std::ptrdiff_t>(offset));
  Json view{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}};
  if (target != GltfTarget::none) view["target"] = static_cast<int>(target);
  root["bufferViews"].push_back(std::move(view));
  return root["bufferViews"].size() - 1;
}

std::size_t GlbBuilder::add_vertex_shorts(std::span<const std::uint16_t> items) {
  const std::vector<std::uint32_t> wide(items.begin(), items.end());
  const std::size_t at = add_accessor(std::span(wide), GltfComponent::unsigned_short, "SCALAR", GltfTarget::vertices);
  root["bufferViews"][root["accessors"][at]["bufferView"].get<std::size_t>()]["byteStride"] = sizeof(std::uint32_t);
  return at;
}

std::size_t GlbBuilder::add_positions(std::span<const Vec3f> positions) {
  constexpr float far = std::numeric_limits<float>::max();
  Vec3f lo{far, far, far}, hi{-far, -far, -far};
  for (const Vec3f p : positions) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  const std::size_t at = add_accessor(positions, GltfComponent::floats, "VEC3", GltfTarget::vertices);
  root["accessors"][at]["min"] = {lo.x, lo.y, lo.z};
  root["accessors"][at]["max"] = {hi.x, hi.y, hi.z};
  return at;
}

std::size_t GlbBuilder::add_indices(std::span<const std::uint32_t> ids, std::size_t vertex_count) {
  if (vertex_count > 0xffff)  // the largest number is reserved
    return add_accessor(ids, GltfComponent::unsigned_int, "SCALAR", GltfTarget::indices);
  const std::vector<std::uint16_t> narrow(ids.begin(), ids.end());
  return add_accessor(std::span(narrow), GltfComponent::unsigned_short, "SCALAR", GltfTarget::indices);
}

void GlbBuilder::add_material(const Material& m, std::size_t texture_count) {
  Json material = surface_json(m, texture_count);
  Json& pbr = material["pbrMetallicRoughness"];
  pbr["baseColorFactor"] = m.base_colour;
  if (m.texture < texture_count) pbr["baseColorTexture"] = {{"index", m.texture}};
  if (!m.name.empty()) material["name"] = m.name;
  Json& used = root["extensionsUsed"];
  list_extensions(material, used);
  if (used.empty()) root.erase("extensionsUsed");
  root["materials"].push_back(std::move(material));
}

void GlbBuilder::complete_materials() {
  const std::size_t plain = root.contains("materials") ? root["materials"].size() : 0;
  bool missing = false;
  for (Json& primitive : root["meshes"][0]["primitives"]) {
    if (primitive.contains("material")) continue;
    primitive["material"] = plain;
    missing = true;
  }
  if (missing) root["materials"].push_back({{"pbrMetallicRoughness", {{"metallicFactor", 0}}}, {"doubleSided", true}});
}

void GlbBuilder::add_embedded_texture(const Texture& t) {
  add_embedded_texture(t, add_view(std::as_bytes(std::span(t.bytes)), GltfTarget::none));
}

void GlbBuilder::add_embedded_texture(const Texture& t, std::size_t view) {
  add_texture(t, {{"bufferView", view}, {"mimeType", t.media_type}});
}

void GlbBuilder::add_linked_texture(const Texture& t, const std::string& uri) { add_texture(t, {{"uri", uri}}); }

void GlbBuilder::add_texture(const Texture& t, Json image) {
  constexpr std::array wraps{10497, 33071, 33648};  // REPEAT, CLAMP_TO_EDGE, MIRRORED_REPEAT
  if (!t.name.empty()) image["name"] = t.name;
  Json sampler{{"wrapS", wraps[static_cast<std::size_t>(t.wrap_u)]},
               {"wrapT", wraps[static_cast<std::size_t>(t.wrap_v)]}};
  if (t.mag_filter != 0) sampler["magFilter"] = t.mag_filter;
  if (t.min_filter != 0) sampler["minFilter"] = t.min_filter;
  root["samplers"].push_back(std::move(sampler));
  root["images"].push_back(std::move(image));
  Json texture{{"sampler", root["samplers"].size() - 1}};
  const std::size_t source = root["images"].size() - 1;
  if (const char* extension = extension_for(t.media_type)) {
    texture["extensions"][extension]["source"] = source;
    add_once(root["extensionsUsed"], extension);
    add_once(root["extensionsRequired"], extension);
  } else {
    texture["source"] = source;
  }
  root["textures"].push_back(std::move(texture));
}

std::vector<std::byte> GlbBuilder::finish() {
  root["buffers"] = {{{"byteLength", binary_.size()}}};
  return pack(root, binary_);
}

// Buffer 0 is that of the file, buffer 1 its decompressed form.
std::vector<std::byte> GlbBuilder::finish_compressed() {
  constexpr const char* extension = "EXT_meshopt_compression";
  std::vector<std::byte> packed;
  std::vector<const Json*> accessor_of(root["bufferViews"].size(), nullptr);
  for (const Json& accessor : root["accessors"]) accessor_of[accessor["bufferView"].get<std::size_t>()] = &accessor;
  for (std::size_t k = 0; k < accessor_of.size(); ++k) {
    Json& view = root["bufferViews"][k];
    if (accessor_of[k] != nullptr) {
      compress_view(view, *accessor_of[k], packed);
    } else {  // an image
      const auto from = binary_.begin() + view["byteOffset"].get<std::ptrdiff_t>();
      view["byteOffset"] = packed.size();
      packed.insert(packed.end(), from, from + view["byteLength"].get<std::ptrdiff_t>());
    }
    packed.resize((packed.size() + 3) / 4 * 4);
  }
  root["buffers"] = {{{"byteLength", packed.size()}},
                     {{"byteLength", binary_.size()}, {"extensions", {{extension, {{"fallback", true}}}}}}};
  add_once(root["extensionsUsed"], extension);
  add_once(root["extensionsRequired"], extension);
  return pack(root, packed);
}

void GlbBuilder::compress_view(Json& view, const Json& accessor, std::vector<std::byte>& packed) const {
  const bool indices = view["target"] == static_cast<int>(GltfTarget::indices);
  const std::size_t length = view["byteLength"].get<std::size_t>(), count = accessor["count"].get<std::size_t>(),
                    stride = length / std::max<std::size_t>(count, 1);
  const auto bytes = std::span(binary_).subspan(view["byteOffset"].get<std::size_t>(), length);
  const std::vector<std::byte> result = compress_meshopt(bytes, count, stride, indices);
  view["buffer"] = 1;
  if (!indices) view["byteStride"] = stride;
  view["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                   {"byteOffset", packed.size()},
                                                   {"byteLength", result.size()},
                                                   {"byteStride", stride},
                                                   {"count", count},
                                                   {"mode", indices ? "INDICES" : "ATTRIBUTES"}};
  packed.insert(packed.end(), result.begin(), result.end());
}

}  // namespace lodestone
