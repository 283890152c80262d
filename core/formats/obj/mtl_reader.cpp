#include "core/formats/obj/mtl_reader.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "core/files/text_scanner.h"

namespace lodestone {
namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

// NaN becomes 0.
float unit_interval(double value) { return value > 0 ? static_cast<float>(std::min(value, 1.0)) : 0.0f; }

void read_colour(TextScanner& scan, MtlMaterial& material) {
  const std::string first(scan.token());
  if (first == "spectral" || first == "xyz") return;  // no colours of a screen
  material.colour[0] = unit_interval(scan.number(first, "a red component"));
  // One value stands for three.
  std::string_view token = scan.token();
  material.colour[1] = token.empty() ? material.colour[0] : unit_interval(scan.number(token, "a green component"));
  token = scan.token();
  material.colour[2] = token.empty() ? material.colour[1] : unit_interval(scan.number(token, "a blue component"));
}

// How many words follow an option of a map: -o, -s and -t take one to three numbers.
int option_words(const std::string& option) {
  if (option == "-mm") return 2;
  return 1;
}

MtlTexture read_texture(TextScanner& scan) {
  MtlTexture texture{.file = {}, .wraps = {}, .place = scan.place()};
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
      if (next_word() == "on") texture.wraps = {TextureWrap::clamp, TextureWrap::clamp};
    } else if (option == "-o" || option == "-s" || option == "-t") {
      for (int i = 0; i < 3 && parse_number(rest.substr(0, rest.find_first_of(" \t"))); ++i) (void)next_word();
    } else {
      for (int i = 0; i < option_words(option); ++i) (void)next_word();
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
    const std::string keyword = lower(scan.token());
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

}  // namespace lodestone
