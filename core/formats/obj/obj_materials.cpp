#include "core/formats/obj/obj_materials.h"

#include <algorithm>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/files/text_scanner.h"

namespace lodestone {
namespace {

// NaN becomes 0.
float unit_interval(double value) { return value > 0 ? static_cast<float>(std::min(value, 1.0)) : 0.0f; }

void read_colour(TextScanner& scan, MtlMaterial& material) {
  const std::string first(scan.token());
  if (first == "spectral" || first == "xyz") return;  // not in a colour space of screens
  material.colour[0] = unit_interval(scan.number(first, "a red component"));
  // One value stands for three.
  std::string_view token = scan.token();
  material.colour[1] = token.empty() ? material.colour[0] : unit_interval(scan.number(token, "a green component"));
  token = scan.token();
  material.colour[2] = token.empty() ? material.colour[1] : unit_interval(scan.number(token, "a blue component"));
}

MtlTexture read_texture(TextScanner& scan) {
  MtlTexture texture{.file = {}, .sampler = {}, .place = scan.place()};
  std::string rest = scan.rest_of_line();
  const auto next_word = [&] {
    const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
    std::string word = rest.substr(0, end);
    rest.erase(0, std::min(rest.find_first_not_of(" \t", end), rest.size()));
    return word;
  };
  while (rest.starts_with('-')) {
    const std::string option = next_word();
    if (option == "-clamp") {
      if (next_word() == "on") texture.sampler = {TextureWrap::clamp, TextureWrap::clamp};
    } else if (option == "-o" || option == "-s" || option == "-t") {  // one to three numbers
      for (int i = 0; i < 3 && parse_number(rest.substr(0, rest.find_first_of(" \t"))); ++i) (void)next_word();
    } else {
      (void)next_word();
      if (option == "-mm") (void)next_word();
    }
  }
  if (rest.empty()) scan.fail("a map without a file name");
  texture.file = rest;
  return texture;
}

}  // namespace

std::vector<MtlMaterial> read_mtl(ByteReader& input) {
  TextScanner scan(input);
  std::vector<MtlMaterial> materials;
  do {
    const std::string keyword = lower_case(scan.token());
    if (keyword == "newmtl") {
      materials.push_back({});
      materials.back().name = scan.rest_of_line();
      continue;
    }
    if (materials.empty()) continue;
    MtlMaterial& material = materials.back();
    if (keyword == "kd") {
      read_colour(scan, material);
    } else if (keyword == "d") {
      std::string_view token = scan.token();
      if (token == "-halo") token = scan.token();
      material.colour[3] = unit_interval(scan.number(token, "a factor of opacity"));
    } else if (keyword == "tr") {
      material.colour[3] = unit_interval(1 - scan.number(scan.token(), "a factor of transparency"));
    } else if (keyword == "map_kd") {
      material.texture = read_texture(scan);
    } else if (keyword == "norm" || ((keyword == "map_bump" || keyword == "bump") && !material.normal_map)) {
      material.normal_map = read_texture(scan);
    }
  } while (scan.next_line());
  return materials;
}

void ObjMaterials::add_libraries(const std::string& names, const std::string& place) {
  if (files_.find(names)) return add_library(names, place);
  std::istringstream words(names);
  for (std::string name; words >> name;) add_library(name, place);
}

void ObjMaterials::add_library(const std::string& name, const std::string& place) {
  const std::optional<std::filesystem::path> path = files_.find(name);
  if (!path) {
    const auto [what, remedy] = files_.absence(name);
    mesh_->warnings.push_back(describe(
        file_, place, "material library " + quote(name) + " " + what + ", and its materials are white", remedy));
    return;
  }
  try {
    ByteReader input(*path);
    for (MtlMaterial& material : read_mtl(input)) {
      std::string key = material.name;
      known_.try_emplace(std::move(key), Entry{std::move(material), input.name()});
    }
  } catch (const Error& error) {
    mesh_->warnings.push_back(std::string(error.what()) + "; the materials of this library are white");
  }
}

std::uint32_t ObjMaterials::use(const std::string& name, const std::string& place) {
  const auto [used, is_new] = used_.try_emplace(name, static_cast<std::uint32_t>(mesh_->materials.size()));
  if (!is_new) return used->second;
  Material material{.name = name};
  if (const auto found = known_.find(name); found != known_.end()) {
    const MtlMaterial& source = found->second.material;
    const std::string& library = found->second.library;
    const auto texture = [&](const std::optional<MtlTexture>& statement) {
      if (!statement) return no_texture;
      return textures_.add_file(statement->file, place + ": " + library + ": " + statement->place, statement->sampler);
    };
    material.base_colour = source.colour;
    if (source.texture) set_colour_texture(material, texture(source.texture));
    material.normal_map = texture(source.normal_map);
  }
  mesh_->materials.push_back(std::move(material));
  return used->second;
}

}  // namespace lodestone
