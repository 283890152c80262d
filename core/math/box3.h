// Axis-aligned boxes, closed on both sides. An empty box has lo > hi and extends to whatever is added first.
#pragma once

#include <algorithm>
#include <limits>

#include "core/math/vec3.h"

namespace lodestone {

template <class Vec>
struct Box3 {
  static constexpr decltype(Vec::x) far = std::numeric_limits<decltype(Vec::x)>::max();
  Vec lo{far, far, far};
  Vec hi{-far, -far, -far};

  [[nodiscard]] bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
  void extend(Vec p) { extend(Box3{p, p}); }
  void extend(const Box3& b) {
    lo = {std::min(lo.x, b.lo.x), std::min(lo.y, b.lo.y), std::min(lo.z, b.lo.z)};
    hi = {std::max(hi.x, b.hi.x), std::max(hi.y, b.hi.y), std::max(hi.z, b.hi.z)};
  }
  [[nodiscard]] bool contains(const Box3& b) const {
    return lo.x <= b.lo.x && lo.y <= b.lo.y && lo.z <= b.lo.z && hi.x >= b.hi.x && hi.y >= b.hi.y && hi.z >= b.hi.z;
  }
  [[nodiscard]] bool contains(Vec p) const { return contains(Box3{p, p}); }
  friend bool operator==(const Box3&, const Box3&) = default;
};

using Box3f = Box3<Vec3f>;
using Box3d = Box3<Vec3d>;

}  // namespace lodestone
