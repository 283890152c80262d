// Pairs the triangles at a nonmanifold edge by their angle around it, so that closed surfaces remain closed when the
// surface is cut there (gueziec2001).
#pragma once

#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone {

// A triangle at an edge, seen from the edge.
struct EdgeTriangle {
  std::uint32_t name = 0;  // the caller's, to tell them apart
  bool forward = false;    // the triangle runs from the lower end to the higher one
  Vec3f third;             // its corner opposite the edge
};

// By coordinates, so that decisions do not depend on how vertices are numbered.
template <class Vec3>
[[nodiscard]] bool is_lower(const Vec3& a, const Vec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

// Names (backward, forward) of triangles that bound the same solid; each is in one pair at most, and none remains if as
// many run forward as backward. is_lower(low, high) holds. At most quadratic in the number of triangles.
[[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint32_t>> pair_around_edge(
    Vec3f low, Vec3f high, const std::vector<EdgeTriangle>& triangles);

}  // namespace lodestone
