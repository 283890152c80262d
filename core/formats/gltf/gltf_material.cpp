#include "core/formats/gltf/gltf_material.h"

#include <algorithm>
#include <cmath>

#include "core/files/text_scanner.h"

namespace lodestone {
namespace {

std::optional<JsonView> extension(const JsonView& value, const char* name) {
  const std::optional<JsonView> extensions = value.find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

// Numbers of OpenGL.
TextureWrap wrap_of(std::uint64_t number) {
  if (number == 33071) return TextureWrap::clamp;
  return number == 33648 ? TextureWrap::mirror : TextureWrap::repeat;
}

void read_uv_map(const JsonView& info, GltfMaterial& material) {
  std::uint64_t set = info.integer_or("texCoord", 0);
  if (const std::optional<JsonView> transform = extension(info, "KHR_texture_transform")) {
    set = transform->integer_or("texCoord", set);
    const auto offset = transform->numbers_or<2>("offset", {0, 0});
    const auto scale = transform->numbers_or<2>("scale", {1, 1});
    const std::optional<JsonView> rotation = transform->find("rotation");
    const double angle = rotation ? rotation->number() : 0, c = std::cos(angle), s = std::sin(angle);
    material.uv_map = {c * scale[0], s * scale[1], -s * scale[0], c * scale[1], offset[0], offset[1]};
  }
  material.uv_attribute = "TEXCOORD_" + std::to_string(set);
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
  Material material{.name = source.string_or("name", "")};
  std::optional<JsonView> colours = source.find("pbrMetallicRoughness");
  const char *factor = "baseColorFactor", *texture = "baseColorTexture";
  if (const auto glossy = extension(source, "KHR_materials_pbrSpecularGlossiness")) {
    colours = glossy;
    factor = "diffuseFactor", texture = "diffuseTexture";
  }
  if (colours) {
    const std::array<double, 4> colour = colours->numbers_or<4>(factor, {1, 1, 1, 1});
    for (std::size_t i = 0; i < 4; ++i)
      material.base_colour[i] = colour[i] > 0 ? static_cast<float>(std::min(colour[i], 1.0)) : 0.0f;
    if (const std::optional<JsonView> info = colours->find(texture)) {
      set_colour_texture(material, read_texture(*info));
      read_uv_map(*info, result);
    }
  }
  if (const std::optional<JsonView> info = source.find("normalTexture")) material.normal_map = read_texture(*info);
  result.index = static_cast<std::uint32_t>(mesh_->materials.size());
  mesh_->materials.push_back(std::move(material));
  return result;
}

std::uint32_t GltfMaterials::read_texture(const JsonView& info) {
  const JsonView texture = document_->item("textures", info.at("index"));
  TextureWraps wraps;
  if (const std::optional<JsonView> reference = texture.find("sampler")) {
    const JsonView sampler = document_->item("samplers", *reference);
    wraps = {wrap_of(sampler.integer_or("wrapS", 10497)), wrap_of(sampler.integer_or("wrapT", 10497))};
  }
  // The plain image first, if there is one: more programs read it.
  if (const std::optional<JsonView> source = texture.find("source")) return read_image(*source, wraps);
  for (const char* name : {"EXT_texture_webp", "KHR_texture_basisu"})
    if (const std::optional<JsonView> other = extension(texture, name)) return read_image(other->at("source"), wraps);
  return no_texture;
}

std::uint32_t GltfMaterials::read_image(const JsonView& reference, TextureWraps wraps) {
  const JsonView image = document_->item("images", reference);
  const auto [known, is_new] = images_.try_emplace({reference.integer(), wraps.u, wraps.v}, no_texture);
  if (!is_new) return known->second;
  std::string name = image.string_or("name", image.place());
  if (const std::optional<JsonView> view = image.find("bufferView")) {
    const std::span<const char> bytes = document_->view(*view).bytes;
    known->second = textures_.add_bytes(name, image.place(), {bytes.begin(), bytes.end()}, wraps);
  } else if (const std::string& uri = image.at("uri").string(); is_data_uri(uri)) {
    known->second = textures_.add_bytes(name, image.place(), decode_data_uri(uri).value_or(std::vector<char>{}), wraps);
  } else {
    known->second = textures_.add_file(percent_decoded(uri), image.place(), wraps);
  }
  return known->second;
}

}  // namespace lodestone
