#include "core/spherical/resample/texture_images.h"

#include <algorithm>
#include <cmath>

#include "core/math/vec2.h"
#include "core/math/vec3.h"

namespace lodestone::spherical {
namespace {

std::uint16_t code(float v) { return static_cast<std::uint16_t>((std::clamp(v, -1.0f, 1.0f) + 1) * 32767.5f + 0.5f); }
float decoded(std::uint16_t v) { return static_cast<float>(v) / 32767.5f - 1; }

Vec3f unit(Vec3f n) {
  const float size = length(n);
  return size > 0 ? (1 / size) * n : Vec3f{0, 0, 1};
}

// (meyer2010)
Vec2f folded(Vec3f n) {
  const float scale = 1 / ((std::abs(n.x) + std::abs(n.y)) + std::abs(n.z));
  const float x = scale * n.x, y = scale * n.y;
  if (n.z >= 0) return {x, y};
  return {std::copysign(1 - std::abs(y), x), std::copysign(1 - std::abs(x), y)};
}

Vec3f unfolded(Vec2f p) {
  const float z = 1 - (std::abs(p.x) + std::abs(p.y));
  if (z >= 0) return unit({p.x, p.y, z});
  return unit({std::copysign(1 - std::abs(p.y), p.x), std::copysign(1 - std::abs(p.x), p.y), z});
}

}  // namespace

WideImage wide_normals(const LinearImage& normals) {
  WideImage image{normals.size, 3, {}};
  image.values.reserve(normals.values.size());
  for (std::size_t p = 0; p < normals.values.size(); p += 3) {
    const Vec3f n = unit({normals.values[p], normals.values[p + 1], normals.values[p + 2]});
    image.values.insert(image.values.end(), {code(n.x), code(n.y), code(n.z)});
  }
  return image;
}

WideImage folded_normals(const LinearImage& normals) {
  WideImage image{normals.size, 2, {}};
  image.values.reserve(normals.values.size() / 3 * 2);
  for (std::size_t p = 0; p < normals.values.size(); p += 3) {
    const Vec2f f = folded(unit({normals.values[p], normals.values[p + 1], normals.values[p + 2]}));
    image.values.insert(image.values.end(), {code(f.x), code(f.y)});
  }
  return image;
}

LinearImage normals_of(const WideImage& image) {
  LinearImage normals{image.size, 3, {}};
  normals.values.reserve(image.values.size() / image.channels * 3);
  for (std::size_t p = 0; p < image.values.size(); p += image.channels) {
    const float x = decoded(image.values[p]), y = decoded(image.values[p + 1]);
    const Vec3f n = image.channels == 2 ? unfolded({x, y}) : unit({x, y, decoded(image.values[p + 2])});
    normals.values.insert(normals.values.end(), {n.x, n.y, n.z});
  }
  return normals;
}

}  // namespace lodestone::spherical
