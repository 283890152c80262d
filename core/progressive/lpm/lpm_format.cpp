#include "core/progressive/lpm/lpm_format.h"

#include <cmath>

#include "core/base/error.h"
#include "core/formats/gltf/gltf_surface.h"
#include "core/math/round_up.h"
#include "core/mesh/up_axis.h"
#include "core/progressive/mesh/octahedral_layout.h"

namespace lodestone::progressive {
namespace {

constexpr std::uint64_t version = 3;  // earlier ones, with parents as plain numbers, were never released
constexpr std::array wraps{"repeat", "clamp", "mirror"};

Json texture_index(std::uint32_t index) { return index == no_texture ? Json(nullptr) : Json(index); }

std::uint32_t read_index(const JsonView& place, const char* key, std::size_t count) {
  const auto member = place.find(key);
  if (!member || member->json().is_null()) return no_texture;
  if (member->integer() >= count) member->fail("the texture does not exist");
  return static_cast<std::uint32_t>(member->integer());
}

TextureWrap read_wrap(const JsonView& place) {
  for (std::size_t k = 0; k < wraps.size(); ++k)
    if (place.string() == wraps[k]) return static_cast<TextureWrap>(k);
  place.fail("unknown texture wrap");
}

std::uint16_t read_filter(const JsonView& place) {
  if (!is_filter(place.integer())) place.fail("unknown filter");
  return static_cast<std::uint16_t>(place.integer());
}

std::uint32_t bits_of(const JsonView& place) {
  const std::uint64_t bits = place.integer();
  if (bits < 4 || bits > 20) place.fail("is not between 4 and 20");
  return static_cast<std::uint32_t>(bits);
}

std::uint32_t count_of(const JsonView& place) {
  if (place.integer() > 0x7fff'ffffu) place.fail("is too large");
  return static_cast<std::uint32_t>(place.integer());
}

void read_geometry(const JsonView& header, LpmHeader& h) {
  h.vertices = count_of(header.at("vertices"));
  h.groups = count_of(header.at("groups"));
  h.base_groups = count_of(header.at("baseGroups"));
  if (h.base_groups > h.groups || h.groups > h.vertices) header.fail("inconsistent counts");
  h.settings = {bits_of(header.at("positionBits")), bits_of(header.at("uvBits")),   header.at("wedges").boolean(),
                header.at("uv").boolean(),          header.at("colours").boolean(), header.at("materialIds").boolean()};
  h.uv_low = header.at("uvLow").numbers<2>();
  h.uv_step = header.at("uvStep").numbers<2>();
  const auto origin = header.at("origin").numbers<3>();
  h.transform = {{origin[0], origin[1], origin[2]}, header.at("scale").number()};
  if (!(h.transform.scale > 0)) header.at("scale").fail("is not positive");
  const std::optional<UpAxis> up = up_axis_named(header.string_or("up", "y"));
  if (!up) header.at("up").fail("unknown up axis");
  h.transform.up = {*up, false};
  // Files without one have lost half a step on each axis.
  h.finest_error = std::ldexp(root_up(3), -1 - static_cast<int>(h.settings.position_bits));
  if (const auto error = header.find("finestError")) h.finest_error = error->number();
}

}  // namespace

Json to_json(const LpmHeader& h) {
  Json materials = Json::array(), textures = Json::array();
  for (const Material& m : h.materials)
    materials.push_back({{"name", m.name},
                         {"colour", m.base_colour},
                         {"texture", texture_index(m.texture)},
                         {"normalMap", texture_index(m.normal_map)},
                         {"surface", surface_json(m, h.textures.size())}});
  for (std::size_t m = 0; m < h.object_normals.size(); ++m)
    materials[m]["objectNormals"] = texture_index(h.object_normals[m]);
  for (std::size_t m = 0; m < h.geometry_images.size(); ++m)
    if (const GeometryTexture& image = h.geometry_images[m]; image.texture != no_texture)
      materials[m]["geometryImage"] = {{"texture", image.texture},
                                       {"origin", {image.origin.x, image.origin.y, image.origin.z}},
                                       {"step", image.step}};
  for (std::size_t m = 0; m < h.octahedral.size(); ++m)
    if (h.octahedral[m]) materials[m]["octahedral"] = to_json(*h.octahedral[m]);
  for (const Texture& t : h.textures) {
    textures.push_back(
        {{"name", t.name},
         {"type", t.media_type},
         {"wrap", {wraps[static_cast<std::size_t>(t.wrap_u)], wraps[static_cast<std::size_t>(t.wrap_v)]}}});
    if (t.mag_filter != 0 || t.min_filter != 0) textures.back()["filters"] = {t.mag_filter, t.min_filter};
  }
  for (std::size_t k = 0; k < h.thumbnails.size(); ++k)
    if (!h.thumbnails[k].empty()) textures[k]["thumbnail"] = h.thumbnails[k];
  Json header{{"version", version},
              {"vertices", h.vertices},
              {"groups", h.groups},
              {"baseGroups", h.base_groups},
              {"positionBits", h.settings.position_bits},
              {"uvBits", h.settings.uv_bits},
              {"wedges", h.settings.wedges},
              {"uv", h.settings.uv},
              {"colours", h.settings.colours},
              {"materialIds", h.settings.materials},
              {"uvLow", h.uv_low},
              {"uvStep", h.uv_step},
              {"origin", {h.transform.origin.x, h.transform.origin.y, h.transform.origin.z}},
              {"scale", h.transform.scale},
              {"finestError", h.finest_error},
              {"up", name_of(h.transform.up.axis)},
              {"materials", materials},
              {"textures", textures}};
  return header;
}

LpmHeader read_header(const JsonView& json) {
  if (const std::uint64_t found = json.at("version").integer(); found != version)
    throw UnsupportedError("version " + std::to_string(found) + " of .lpm is not supported");
  LpmHeader h;
  read_geometry(json, h);
  const JsonView textures = json.at("textures"), materials = json.at("materials");
  for (std::size_t k = 0; k < textures.size(); ++k) {
    const JsonView t = textures.at(k), wrap = t.at("wrap");
    h.textures.push_back({t.string_or("name", ""),
                          t.at("type").string(),
                          read_wrap(wrap.at(std::size_t{0})),
                          read_wrap(wrap.at(std::size_t{1})),
                          {}});
    if (const auto filters = t.find("filters")) {
      h.textures.back().mag_filter = read_filter(filters->at(std::size_t{0}));
      h.textures.back().min_filter = read_filter(filters->at(std::size_t{1}));
    }
    h.thumbnails.push_back(t.string_or("thumbnail", ""));
  }
  for (std::size_t k = 0; k < materials.size(); ++k) {
    const JsonView m = materials.at(k);
    Material material{m.string_or("name", "")};
    const auto colour = m.at("colour").numbers<4>();
    for (std::size_t i = 0; i < 4; ++i) material.base_colour[i] = static_cast<float>(colour[i]);
    material.texture = read_index(m, "texture", h.textures.size());
    material.normal_map = read_index(m, "normalMap", h.textures.size());
    if (const auto surface = m.find("surface")) read_surface(*surface, textures_of_mesh(h.textures.size()), material);
    if (m.find("objectNormals")) {
      h.object_normals.resize(k + 1, no_texture);
      h.object_normals[k] = read_index(m, "objectNormals", h.textures.size());
    }
    if (const auto image = m.find("geometryImage")) {
      h.geometry_images.resize(k + 1);
      const auto corner = image->at("origin").numbers<3>();
      h.geometry_images[k] = {read_index(*image, "texture", h.textures.size()),
                              {corner[0], corner[1], corner[2]},
                              image->at("step").number()};
    }
    if (const auto octahedral = m.find("octahedral")) {
      h.octahedral.resize(k + 1);
      h.octahedral[k] = read_octahedral_layout(*octahedral);
    }
    h.materials.push_back(std::move(material));
  }
  if (!h.object_normals.empty()) h.object_normals.resize(h.materials.size(), no_texture);
  if (!h.geometry_images.empty()) h.geometry_images.resize(h.materials.size());
  if (!h.octahedral.empty()) h.octahedral.resize(h.materials.size());
  return h;
}

}  // namespace lodestone::progressive
