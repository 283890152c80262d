// Where the surface of the model ends, as far as that is known: tells the outline of a piece from a seam, and a gap of
// the model from one between pieces.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone {

struct BorderPoint {
  Vec3f position;  // normalised model space
  Vec3f outward;   // of unit length or zero: in the plane of the triangle there, across the border, away from it
};

class ModelBorder {
 public:
  // Points farther apart than `reach` know nothing of each other; > 0. The points are copied, by cells.
  ModelBorder(std::span<const BorderPoint> points, float reach);

  [[nodiscard]] bool is_near(Vec3f p) const;
  // True if the surface ends before it comes to the point; false, too, if no border is within reach.
  [[nodiscard]] bool is_beyond(Vec3f p) const {
    const BorderPoint* at = nearest(p);
    return at && dot(p - at->position, at->outward) > 0;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  [[nodiscard]] Cell cell(Vec3f p) const;
  [[nodiscard]] static std::uint64_t key(const Cell& c);
  // The first of equally near points.
  [[nodiscard]] const BorderPoint* nearest(Vec3f p) const;

  float reach_;
  // By cubic cells. Cells repeat after 2^21 of them along an axis: points of one may be far away.
  std::unordered_map<std::uint64_t, std::vector<BorderPoint>> cells_;
};

}  // namespace lodestone
