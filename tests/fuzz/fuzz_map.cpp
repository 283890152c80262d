// Position maps in files: any bytes, as OpenEXR and as a portable float map, give a map without holes in its arrays and
// without a number that is not finite, or an InputError.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "core/base/error.h"
#include "render/position_map/read_map.h"

namespace {

using namespace lodestone;

void require(bool holds) {
  if (!holds) std::abort();
}

void check(const PositionMap& map) {
  const std::size_t n = map.view.pixels();
  require(map.position.size() == n && map.triangle.size() == n && map.depth.size() == n);
  for (std::size_t i = 0; i < n; ++i) {
    require(is_finite(map.position[i]) && std::isfinite(map.depth[i]));
    require(map.normal.empty() || is_finite(map.normal[i]));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  MapView view;
  view.eye = {0.5, 0.5, 2};
  view.width = view.height = 1;
  for (const auto parse : {parse_exr_map, parse_pfm_map}) {
    try {
      check(parse(bytes, "fuzz", view, {}));
    } catch (const InputError&) {
    }
  }
  return 0;
}
