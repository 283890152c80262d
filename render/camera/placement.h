// Placement of a model: a similarity, since levels of detail are chosen by distances, which a similarity keeps in
// proportion.
#pragma once

#include <array>

#include "core/math/vec3.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// x -> translation + scale rotation x.
struct Similarity {
  std::array<Vec3d, 3> rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // rows, orthonormal
  double scale = 1;                                                  // positive
  Vec3d translation;

  [[nodiscard]] Vec3d rotated(Vec3d v) const { return {dot(rotation[0], v), dot(rotation[1], v), dot(rotation[2], v)}; }
  [[nodiscard]] Vec3d rotated_back(Vec3d v) const {
    return v.x * rotation[0] + (v.y * rotation[1] + v.z * rotation[2]);
  }
  [[nodiscard]] Vec3d operator()(Vec3d p) const { return translation + scale * rotated(p); }
  [[nodiscard]] Vec3d inverse(Vec3d p) const { return (1 / scale) * rotated_back(p - translation); }
  friend bool operator==(const Similarity&, const Similarity&) = default;
};

// First `inner`, then `outer`.
[[nodiscard]] Similarity operator*(const Similarity& outer, const Similarity& inner);

// Turned about x, then y, then z, each in degrees.
[[nodiscard]] std::array<Vec3d, 3> rotation_about_axes(Vec3d degrees);

// From a model's normalised space to its own.
[[nodiscard]] inline Similarity to_similarity(const Transform& transform) {
  return {.scale = transform.scale, .translation = transform.origin};
}

}  // namespace lodestone
