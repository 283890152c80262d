#include "core/formats/gltf/gltf_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace lodestone {
namespace {

constexpr const char *placed = "KHR_texture_transform", *unlit = "KHR_materials_unlit";
constexpr std::array alpha_modes{"OPAQUE", "MASK", "BLEND"};
constexpr int max_depth = 16;  // of extensions, which are nested three deep

float finite_float(double value) {
  constexpr double most = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(value, -most, most));
}

float number_or(const JsonView& source, const char* key, float otherwise) {
  const std::optional<JsonView> member = source.find(key);
  return member ? finite_float(member->number()) : otherwise;
}

float share_or(const JsonView& source, const char* key, float otherwise) {
  return std::clamp(number_or(source, key, otherwise), 0.0f, 1.0f);
}

bool names_texture(std::string_view key, const Json& value) {
  return key.ends_with("Texture") && value.is_object() && value.contains("index");
}

// Extensions with the numbers of their textures taken out, and put into `textures`.
class ExtensionReader {
 public:
  ExtensionReader(const ReadTexture& read_texture, std::vector<std::uint32_t>& textures)
      : read_texture_(read_texture), textures_(textures) {}

  Json read(const JsonView& source, int depth = 0) {
    if (depth > max_depth) source.fail("is nested more than " + std::to_string(max_depth) + " deep");
    Json out = source.json().is_array() ? Json::array() : Json::object();
    if (source.json().is_array()) {
      for (std::size_t k = 0; k < source.size(); ++k) out.push_back(value(source.at(k), depth));
      return out;
    }
    for (const auto& [key, item] : source.json().items()) {
      const JsonView member = source.at(key.c_str());
      if (!names_texture(key, item)) {
        out[key] = value(member, depth);
      } else if (const PlacedTexture texture = read_texture_(member); texture.texture != no_texture) {
        out[key] = read_info(member, texture, depth);
      }
    }
    return out;
  }

 private:
  Json value(const JsonView& source, int depth) {
    return source.json().is_structured() ? read(source, depth + 1) : source.json();
  }

  // Other members of a textureInfo, as a scale, are kept.
  Json read_info(const JsonView& source, const PlacedTexture& texture, int depth) {
    Json info = value(source, depth);
    info.erase("texCoord");
    if (info.contains("extensions")) info["extensions"].erase(placed);
    if (texture.transform != UvTransform{})
      info["extensions"][placed] = texture_info(texture)["extensions"][placed];
    else if (info.contains("extensions") && info["extensions"].empty())
      info.erase("extensions");
    info["index"] = textures_.size();
    textures_.push_back(texture.texture);
    return info;
  }

  const ReadTexture& read_texture_;
  std::vector<std::uint32_t>& textures_;
};

// The inverse.
void put_textures(Json& extensions, const Material& m, std::size_t texture_count) {
  if (extensions.is_array())
    for (Json& item : extensions) put_textures(item, m, texture_count);
  if (!extensions.is_object()) return;
  const auto is_lost = [&](const auto& member) {
    if (!names_texture(member.first, member.second)) return false;
    const auto k = member.second["index"].template get<std::size_t>();
    return k >= m.extension_textures.size() || m.extension_textures[k] >= texture_count;
  };
  std::erase_if(extensions.items(), is_lost);
  for (auto& [name, value] : extensions.items()) {
    if (names_texture(name, value)) value["index"] = m.extension_textures[value["index"].get<std::size_t>()];
    put_textures(value, m, texture_count);
  }
}

void read_extensions(const JsonView& source, const ReadTexture& read_texture, Material& m) {
  const std::optional<JsonView> extensions = source.find("extensions");
  if (!extensions || !extensions->json().is_object()) return;
  Json kept;
  for (const auto& [key, value] : extensions->json().items()) {
    if (key == unlit)
      m.unlit = true;
    else if (key.starts_with("KHR_materials_") && value.is_object())
      kept[key] = ExtensionReader(read_texture, m.extension_textures).read(extensions->at(key.c_str()));
  }
  if (!kept.is_null()) m.extensions = kept.dump();
}

AlphaMode read_alpha_mode(const JsonView& source) {
  const std::string name = source.string_or("alphaMode", "OPAQUE");
  for (std::size_t k = 0; k < alpha_modes.size(); ++k)
    if (name == alpha_modes[k]) return static_cast<AlphaMode>(k);
  source.at("alphaMode").fail("unknown alpha mode '" + name + "'");
}

}  // namespace

std::optional<JsonView> extension(const JsonView& value, const char* name) {
  const std::optional<JsonView> extensions = value.find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

UvTransform read_uv_transform(const JsonView& info) {
  UvTransform out;
  const std::optional<JsonView> source = extension(info, placed);
  if (!source) return out;
  const auto offset = source->numbers_or<2>("offset", {0, 0}), scale = source->numbers_or<2>("scale", {1, 1});
  for (std::size_t k = 0; k < 2; ++k) out.offset[k] = finite_float(offset[k]), out.scale[k] = finite_float(scale[k]);
  out.rotation = number_or(*source, "rotation", 0);
  return out;
}

Json texture_info(const PlacedTexture& texture) {
  Json info{{"index", texture.texture}};
  if (texture.transform == UvTransform{}) return info;
  const UvTransform &t = texture.transform, none;
  Json& to = info["extensions"][placed] = Json::object();
  if (t.offset != none.offset) to["offset"] = t.offset;
  if (t.scale != none.scale) to["scale"] = t.scale;
  if (t.rotation != none.rotation) to["rotation"] = t.rotation;
  return info;
}

ReadTexture textures_of_mesh(std::size_t count) {
  return [count](const JsonView& info) -> PlacedTexture {
    const JsonView index = info.at("index");
    if (index.integer() >= count) index.fail("the texture does not exist");
    return {static_cast<std::uint32_t>(index.integer()), read_uv_transform(info)};
  };
}

Json surface_json(const Material& m, std::size_t texture_count) {
  Json pbr{{"metallicFactor", m.metallic}}, out = Json::object();
  const auto put = [&](Json& to, const char* key, const PlacedTexture& texture) {
    if (texture.texture >= texture_count) return false;
    to[key] = texture_info(texture);
    return true;
  };
  if (m.roughness != 1) pbr["roughnessFactor"] = m.roughness;
  put(pbr, "metallicRoughnessTexture", m.metallic_roughness);
  out["pbrMetallicRoughness"] = std::move(pbr);
  if (put(out, "normalTexture", {m.normal_map, m.normal_transform}) && m.normal_scale != 1)
    out["normalTexture"]["scale"] = m.normal_scale;
  if (put(out, "occlusionTexture", m.occlusion) && m.occlusion_strength != 1)
    out["occlusionTexture"]["strength"] = m.occlusion_strength;
  if (m.emissive != std::array<float, 3>{}) out["emissiveFactor"] = m.emissive;
  put(out, "emissiveTexture", m.emissive_map);
  if (m.alpha_mode != AlphaMode::opaque) out["alphaMode"] = alpha_modes[static_cast<std::size_t>(m.alpha_mode)];
  if (m.alpha_mode == AlphaMode::mask && m.alpha_cutoff != 0.5f) out["alphaCutoff"] = m.alpha_cutoff;
  if (m.double_sided) out["doubleSided"] = true;
  if (!m.extensions.empty()) {
    Json extensions = Json::parse(m.extensions);
    put_textures(extensions, m, texture_count);
    out["extensions"] = std::move(extensions);
  }
  if (m.unlit) out["extensions"][unlit] = Json::object();
  return out;
}

void read_surface(const JsonView& source, const ReadTexture& read_texture, Material& m) {
  m.metallic = m.roughness = 1;
  if (const std::optional<JsonView> pbr = source.find("pbrMetallicRoughness")) {
    m.metallic = share_or(*pbr, "metallicFactor", 1);
    m.roughness = share_or(*pbr, "roughnessFactor", 1);
    if (const auto info = pbr->find("metallicRoughnessTexture")) m.metallic_roughness = read_texture(*info);
  }
  if (const std::optional<JsonView> info = source.find("normalTexture")) {
    const PlacedTexture normals = read_texture(*info);
    m.normal_map = normals.texture;
    if (normals.texture != no_texture) {
      m.normal_transform = normals.transform;
      m.normal_scale = number_or(*info, "scale", 1);
    }
  }
  if (const std::optional<JsonView> info = source.find("occlusionTexture")) {
    m.occlusion = read_texture(*info);
    if (m.occlusion.texture != no_texture) m.occlusion_strength = share_or(*info, "strength", 1);
  }
  const auto emissive = source.numbers_or<3>("emissiveFactor", {0, 0, 0});
  for (std::size_t k = 0; k < 3; ++k) m.emissive[k] = std::clamp(finite_float(emissive[k]), 0.0f, 1.0f);
  if (const std::optional<JsonView> info = source.find("emissiveTexture")) m.emissive_map = read_texture(*info);
  m.alpha_mode = read_alpha_mode(source);
  if (m.alpha_mode == AlphaMode::mask) m.alpha_cutoff = std::max(number_or(source, "alphaCutoff", 0.5f), 0.0f);
  m.double_sided = source.boolean_or("doubleSided", false);
  read_extensions(source, read_texture, m);
}

float emissive_strength(const Material& material) {
  if (material.extensions.empty()) return 1;
  const Json extensions = Json::parse(material.extensions);
  const Json* const found = extensions.find("KHR_materials_emissive_strength");
  const Json* const strength = found ? found->find("emissiveStrength") : nullptr;
  const bool known = strength && strength->is_number();
  return known ? std::max(finite_float(strength->get<double>()), 0.0f) : 1;
}

void set_emissive_strength(Material& material, float strength) {
  Json extensions = material.extensions.empty() ? Json::object() : Json::parse(material.extensions);
  extensions.erase("KHR_materials_emissive_strength");
  if (strength != 1) extensions["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
  material.extensions = extensions.empty() ? "" : extensions.dump();
}

void list_extensions(const Json& material, Json& names) {
  if (material.is_array())
    for (const Json& item : material) list_extensions(item, names);
  if (!material.is_object()) return;
  if (const Json* const extensions = material.find("extensions"))
    for (const auto& [name, value] : extensions->items())
      if (std::find(names.begin(), names.end(), Json(name)) == names.end()) names.push_back(name);
  for (const auto& [name, value] : material.items()) list_extensions(value, names);
}

}  // namespace lodestone
