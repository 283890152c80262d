// Numbered points by where they are: a hash of cubic cells.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone {

// Cells repeat after 2^21 of them along an axis: what is visited may be far away, and has to be looked at.
class VertexGrid {
 public:
  explicit VertexGrid(float side) : side_(side) {}
  void insert(std::uint32_t v, Vec3f p) { cells_[key(cell(p))].push_back(v); }
  template <class Visit>
  void for_near(Vec3f p, float radius, const Visit& visit) const {
    const auto lo = cell({p.x - radius, p.y - radius, p.z - radius}),
               hi = cell({p.x + radius, p.y + radius, p.z + radius});
    for (std::int64_t z = lo[2]; z <= hi[2]; ++z)
      for (std::int64_t y = lo[1]; y <= hi[1]; ++y)
        for (std::int64_t x = lo[0]; x <= hi[0]; ++x)
          if (const auto at = cells_.find(key({x, y, z})); at != cells_.end())
            for (const std::uint32_t v : at->second) visit(v);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  [[nodiscard]] Cell cell(Vec3f p) const {
    return {static_cast<std::int64_t>(std::floor(p.x / side_)), static_cast<std::int64_t>(std::floor(p.y / side_)),
            static_cast<std::int64_t>(std::floor(p.z / side_))};
  }
  [[nodiscard]] static std::uint64_t key(const Cell& c) {
    const auto part = [](std::int64_t v) { return static_cast<std::uint64_t>(v) & 0x1F'FFFF; };
    return part(c[0]) | part(c[1]) << 21 | part(c[2]) << 42;
  }
  float side_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace lodestone
