#include "core/formats/gltf/gltf_material.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/files/text_scanner.h"
#include "core/formats/gltf/gltf_surface.h"

namespace lodestone {
namespace {

constexpr const char* glossy = "KHR_materials_pbrSpecularGlossiness";

// The base colour: the object that holds it, and its members there.
struct BaseColour {
  std::optional<JsonView> source;
  const char *factor, *texture;
};
BaseColour base_colour_of(const JsonView& material) {
  if (const auto source = extension(material, glossy)) return {source, "diffuseFactor", "diffuseTexture"};
  return {material.find("pbrMetallicRoughness"), "baseColorFactor", "baseColorTexture"};
}

// Numbers of OpenGL.
TextureWrap wrap_of(std::uint64_t number) {
  if (number == 33071) return TextureWrap::clamp;
  return number == 33648 ? TextureWrap::mirror : TextureWrap::repeat;
}

std::uint16_t filter_of(const JsonView& sampler, const char* key) {
  const std::uint64_t number = sampler.integer_or(key, 0);
  return is_filter(number) ? static_cast<std::uint16_t>(number) : std::uint16_t{0};
}

std::uint64_t uv_set_of(const JsonView& info) {
  const std::uint64_t set = info.integer_or("texCoord", 0);
  const std::optional<JsonView> transform = extension(info, "KHR_texture_transform");
  return transform ? transform->integer_or("texCoord", set) : set;
}

// The textureInfo whose coordinates the mesh gets.
std::optional<JsonView> first_texture(const JsonView& source) {
  const BaseColour colour = base_colour_of(source);
  if (const auto info = colour.source ? colour.source->find(colour.texture) : std::nullopt) return info;
  if (const auto info = source.find("normalTexture")) return info;
  if (const auto pbr = source.find("pbrMetallicRoughness"))
    if (const auto info = pbr->find("metallicRoughnessTexture")) return info;
  for (const char* name : {"emissiveTexture", "occlusionTexture"})
    if (const auto info = source.find(name)) return info;
  return std::nullopt;
}

// Told from the name of the textureInfo.
PixelMeaning meaning_of(const JsonView& info) {
  const std::string& name = info.place();
  if (name.ends_with("ormalTexture")) return PixelMeaning::normals;
  if (name.ends_with("olorTexture") || name.ends_with("missiveTexture")) return PixelMeaning::colours;
  return PixelMeaning::values;
}

}  // namespace

Vec2f GltfMaterial::map(double u, double v) const {
  const auto& [a, b, c, d, x, y] = uv_map;
  return {static_cast<float>(a * u + b * v + x), static_cast<float>(c * u + d * v + y)};
}

const GltfMaterial& GltfMaterials::use(const JsonView& reference) {
  const JsonView source = document_->item("materials", reference);
  const auto [used, is_new] = used_.try_emplace(reference.integer());
  if (is_new) used->second = read(source);
  return used->second;
}

GltfMaterial GltfMaterials::read(const JsonView& source) {
  GltfMaterial result;
  if (const std::optional<JsonView> info = first_texture(source)) {
    result.uv_attribute = "TEXCOORD_" + std::to_string(uv_set_of(*info));
    result.uv_map = map_of(read_uv_transform(*info));
  }
  Material material{.name = source.string_or("name", "")};
  read_base_colour(source, result, material);
  read_surface(
      source, [&](const JsonView& info) { return place(info, result); }, material);
  if (const auto gloss = extension(source, glossy); gloss && !source.find("pbrMetallicRoughness")) {
    const std::optional<JsonView> factor = gloss->find("glossinessFactor");
    material.metallic = 0;
    material.roughness = factor ? static_cast<float>(std::clamp(1 - factor->number(), 0.0, 1.0)) : 0.0f;
  }
  if (const std::optional<JsonView> extensions = source.find("extensions");
      extensions && extensions->json().is_object())
    for (const auto& [name, value] : extensions->json().items())
      if (!name.starts_with("KHR_materials_")) ++left_out_["materials use " + name + ", which is left out"];
  // This program writes such a material where there is none.
  if (material == Material{} && !source.find("extras")) return result;
  result.index = static_cast<std::uint32_t>(mesh_->materials.size());
  mesh_->materials.push_back(std::move(material));
  return result;
}

void GltfMaterials::read_base_colour(const JsonView& source, GltfMaterial& placement, Material& material) {
  const BaseColour from = base_colour_of(source);
  if (!from.source) return;
  const std::array<double, 4> colour = from.source->numbers_or<4>(from.factor, {1, 1, 1, 1});
  for (std::size_t i = 0; i < 4; ++i)
    material.base_colour[i] = colour[i] > 0 ? static_cast<float>(std::min(colour[i], 1.0)) : 0.0f;
  if (const std::optional<JsonView> info = from.source->find(from.texture))
    set_colour_texture(material, place(*info, placement).texture);
}

PlacedTexture GltfMaterials::place(const JsonView& info, GltfMaterial& placement) {
  const std::string attribute = "TEXCOORD_" + std::to_string(uv_set_of(info));
  const UvTransform own = read_uv_transform(info);
  std::optional<UvTransform> transform;
  if (attribute == placement.uv_attribute)
    transform = placement.uv_map == map_of({}) ? own : transform_after(placement.uv_map, map_of(own));
  const std::uint32_t texture = read_texture(info);
  if (transform || texture == no_texture) return {texture, transform.value_or(UvTransform{})};
  placement.misplaced.push_back(misplaced_.maps().size());
  const auto material = static_cast<std::uint32_t>(mesh_->materials.size());  // it will be
  return {
      misplaced_.add(*mesh_, texture, {material, no_texture, no_texture, attribute, map_of(own), meaning_of(info)})};
}

std::vector<std::string> GltfMaterials::finish() {
  std::vector<std::string> lines = misplaced_.finish(*mesh_);
  for (const auto& [what, count] : left_out_) lines.push_back(std::to_string(count) + " " + what);
  for (std::string& line : lines) line = describe(document_->file(), "", line);
  return lines;
}

std::uint32_t GltfMaterials::read_texture(const JsonView& info) {
  const JsonView texture = document_->item("textures", info.at("index"));
  TextureSampler sampler;
  if (const std::optional<JsonView> reference = texture.find("sampler")) {
    const JsonView source = document_->item("samplers", *reference);
    sampler = {wrap_of(source.integer_or("wrapS", 10497)), wrap_of(source.integer_or("wrapT", 10497)),
               filter_of(source, "magFilter"), filter_of(source, "minFilter")};
  }
  // The plain image first, if there is one: more programs read it.
  if (const std::optional<JsonView> source = texture.find("source")) return read_image(*source, sampler);
  for (const char* name : {"EXT_texture_webp", "KHR_texture_basisu"})
    if (const std::optional<JsonView> other = extension(texture, name)) return read_image(other->at("source"), sampler);
  return no_texture;
}

std::uint32_t GltfMaterials::read_image(const JsonView& reference, const TextureSampler& sampler) {
  const JsonView image = document_->item("images", reference);
  const auto [known, is_new] = images_.try_emplace({reference.integer(), sampler}, no_texture);
  if (!is_new) return known->second;
  std::string name = image.string_or("name", image.place());
  if (const std::optional<JsonView> view = image.find("bufferView")) {
    const std::span<const char> bytes = document_->view(*view).bytes;
    known->second = textures_.add_bytes(name, image.place(), {bytes.begin(), bytes.end()}, sampler);
  } else if (const std::string& uri = image.at("uri").string(); is_data_uri(uri)) {
    known->second =
        textures_.add_bytes(name, image.place(), decode_data_uri(uri).value_or(std::vector<char>{}), sampler);
  } else {
    known->second = textures_.add_file(percent_decoded(uri), image.place(), sampler);
  }
  return known->second;
}

}  // namespace lodestone
