#include "parallel/spherical/spherical_maps.h"

#include <algorithm>
#include <array>

#include "core/base/error.h"

namespace lodestone {
namespace {

struct MapName {
  std::string_view name;
  bool SphericalMaps::*map;
};
constexpr std::array map_names{MapName{"colour", &SphericalMaps::colour}, MapName{"normal", &SphericalMaps::normal},
                               MapName{"geometry", &SphericalMaps::geometry}};

}  // namespace

std::string to_string(const SphericalMaps& maps) {
  std::string names;
  for (const MapName& map : map_names)
    if (maps.*map.map) names.append(names.empty() ? "" : ",").append(map.name);
  return names;
}

SphericalMaps spherical_maps(std::string_view names) {
  SphericalMaps maps, all;
  for (const MapName& map : map_names) maps.*map.map = false, all.*map.map = true;
  for (std::size_t at = 0, end = 0; end != std::string_view::npos; at = end + 1) {
    end = names.find(',', at);
    const std::string_view name = names.substr(at, end - at);
    const auto map = std::ranges::find(map_names, name, &MapName::name);
    if (map == map_names.end())
      throw InputError(describe({}, {}, "unknown map '" + std::string(name) + "'", "name some of " + to_string(all)));
    maps.*map->map = true;
  }
  return maps;
}

}  // namespace lodestone
