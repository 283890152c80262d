// Which octahedral images are made, and their names.
#pragma once

#include <string>
#include <string_view>

namespace lodestone {

// The images that a component gets.
struct SphericalMaps {
  bool colour = true;     // and the other images of the materials, as far as these have any
  bool normal = true;     // in object space
  bool geometry = false;  // positions, by a fourth as many samples along a side as the others have pixels, and one
};
// From names separated by commas; throws InputError listing the known ones.
[[nodiscard]] SphericalMaps spherical_maps(std::string_view names);
[[nodiscard]] std::string to_string(const SphericalMaps& maps);

}  // namespace lodestone
