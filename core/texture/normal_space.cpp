#include "core/texture/normal_space.h"

#include <cmath>

#include "core/math/vec3.h"

namespace lodestone {

bool is_object_space(const PixelImage& normal_map) {
  if (normal_map.channels < 3) return false;
  std::size_t units = 0, inwards = 0;
  for (std::size_t p = 0; p < normal_map.pixels.size(); p += normal_map.channels) {
    const auto component = [&](std::size_t c) { return static_cast<float>(normal_map.pixels[p + c]) / 127.5f - 1; };
    const Vec3f n{component(0), component(1), component(2)};
    if (std::abs(dot(n, n) - 1) > 0.5f) continue;  // between charts
    ++units;
    inwards += n.z < -0.1f;
  }
  return inwards > units / 16;
}

}  // namespace lodestone
