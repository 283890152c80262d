#include "core/formats/obj/obj_materials.h"

#include <algorithm>
#include <array>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/files/text_scanner.h"

namespace lodestone {
namespace {

// NaN becomes 0.
float unit_interval(double value) { return value > 0 ? static_cast<float>(std::min(value, 1.0)) : 0.0f; }

void read_colour(TextScanner& scan, std::span<float> colour) {
  const std::string first(scan.token());
  if (first == "spectral" || first == "xyz") return;  // not in a colour space of screens
  colour[0] = unit_interval(scan.number(first, "a red component"));
  // One value stands for three.
  std::string_view token = scan.token();
  colour[1] = token.empty() ? colour[0] : unit_interval(scan.number(token, "a green component"));
  token = scan.token();
  colour[2] = token.empty() ? colour[1] : unit_interval(scan.number(token, "a blue component"));
}

// True if the rest of the line has a number other than `neutral`.
bool says_other_than(TextScanner& scan, double neutral) {
  for (std::string_view token = scan.token(); !token.empty(); token = scan.token())
    if (const std::optional<double> value = parse_number(token); value && *value != neutral) return true;
  return false;
}

// Statements about the look of a surface that have no place in a Material: what they say, and the value that says
// nothing; a map always says something.
struct LeftOut {
  std::string_view keyword, what;
  std::optional<double> neutral;
};
constexpr std::array left_out_statements{LeftOut{"ks", "colours of highlights (Ks)", 0.0},
                                         LeftOut{"map_ks", "maps of highlights (map_Ks, map_Ns)", {}},
                                         LeftOut{"map_ns", "maps of highlights (map_Ks, map_Ns)", {}},
                                         LeftOut{"map_d", "maps of opacity (map_d)", {}},
                                         LeftOut{"map_pr", "maps of roughness and metal (map_Pr, map_Pm)", {}},
                                         LeftOut{"map_pm", "maps of roughness and metal (map_Pr, map_Pm)", {}},
                                         LeftOut{"tf", "filters of light (Tf)", 1.0},
                                         LeftOut{"refl", "reflection maps (refl)", {}},
                                         LeftOut{"disp", "displacement maps (disp)", {}},
                                         LeftOut{"decal", "decals (decal)", {}},
                                         LeftOut{"ps", "sheen and clear coats (Ps, Pc, Pcr)", 0.0},
                                         LeftOut{"pc", "sheen and clear coats (Ps, Pc, Pcr)", 0.0}};

void note_left_out(TextScanner& scan, std::string_view keyword, MtlMaterial& material) {
  for (const LeftOut& statement : left_out_statements) {
    if (statement.keyword != keyword) continue;
    if (!statement.neutral || says_other_than(scan, *statement.neutral)) material.left_out.emplace(statement.what);
  }
}

MtlTexture read_texture(TextScanner& scan, MtlMaterial& material) {
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
      const double neutral = option == "-s" ? 1 : 0;
      bool moved = false;
      for (int i = 0; i < 3 && parse_number(rest.substr(0, rest.find_first_of(" \t"))); ++i)
        moved |= *parse_number(next_word()) != neutral;
      if (moved) material.left_out.emplace("places and scales of maps (-o, -s, -t)");
    } else if (option == "-bm") {
      if (const std::optional<double> bump = parse_number(next_word())) texture.bump = static_cast<float>(*bump);
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
      read_colour(scan, material.colour);
    } else if (keyword == "ke") {
      read_colour(scan, material.emission);
    } else if (keyword == "d") {
      std::string_view token = scan.token();
      if (token == "-halo") token = scan.token();
      material.colour[3] = unit_interval(scan.number(token, "a factor of opacity"));
    } else if (keyword == "tr") {
      material.colour[3] = unit_interval(1 - scan.number(scan.token(), "a factor of transparency"));
    } else if (keyword == "map_kd") {
      material.texture = read_texture(scan, material);
    } else if (keyword == "map_ke") {
      material.emission_map = read_texture(scan, material);
    } else if (keyword == "pr") {
      material.roughness = unit_interval(scan.number(scan.token(), "a roughness"));
    } else if (keyword == "pm") {
      material.metal = unit_interval(scan.number(scan.token(), "a share of metal"));
    } else if (keyword == "norm" || ((keyword == "map_bump" || keyword == "bump") && !material.normal_map)) {
      material.normal_map = read_texture(scan, material);
    } else {
      note_left_out(scan, keyword, material);
    }
  } while (scan.next_line());
  return materials;
}

void ObjMaterials::add_libraries(const std::string& names, const std::string& place) {
  if (files_.find(names)) return add_library(names, place);
  std::istringstream words(names);
  words.exceptions(std::ios::badbit);  // no memory
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
  if (!libraries_.insert(std::filesystem::weakly_canonical(*path)).second) return;
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
    if (source.colour[3] < 1) material.alpha_mode = AlphaMode::blend;
    if (source.texture) set_colour_texture(material, texture(source.texture));
    material.normal_map = texture(source.normal_map);
    if (material.normal_map != no_texture) material.normal_scale = source.normal_map->bump;
    material.emissive = source.emission;
    material.emissive_map = {texture(source.emission_map), {}};
    // A map without a colour says the colour itself.
    if (source.emission_map && source.emission == std::array<float, 3>{}) material.emissive = {1, 1, 1};
    material.roughness = source.roughness.value_or(material.roughness);
    material.metallic = source.metal.value_or(material.metallic);
    for (const std::string& what : source.left_out) ++left_out_[what];
  }
  mesh_->materials.push_back(std::move(material));
  return used->second;
}

void ObjMaterials::add_notes() {
  for (const auto& [what, count] : left_out_)
    mesh_->warnings.push_back(describe(
        file_, "",
        what + " of " + std::to_string(count) + (count == 1 ? " material is" : " materials are") + " left out"));
}

}  // namespace lodestone
