// The triangles around a vertex on the texture.
#pragma once

#include <span>

#include "core/math/vec3.h"
#include "core/progressive/collapse/ring_mesh.h"

namespace lodestone::progressive {

// Twice the signed area of a triangle.
[[nodiscard]] inline double uv_area(Vec2f a, Vec2f b, Vec2f c) {
  return (double{b.x} - a.x) * (double{c.y} - a.y) - (double{b.y} - a.y) * (double{c.x} - a.x);
}

// True if a triangle that is kept would be turned over, or flattened, on the texture.
[[nodiscard]] bool turns_texture(const RingMesh& rings, std::span<const Vec2f> uv, const Collapse& collapse);

}  // namespace lodestone::progressive
