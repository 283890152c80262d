#include "render/reconstruct/seams/model_border.h"

#include <cmath>

namespace lodestone {

ModelBorder::ModelBorder(std::span<const BorderPoint> points, float reach) : reach_(reach) {
  for (const BorderPoint& point : points) cells_[key(cell(point.position))].push_back(point);
}

ModelBorder::Cell ModelBorder::cell(Vec3f p) const {
  const auto along = [&](float x) { return static_cast<std::int64_t>(std::floor(x / reach_)); };
  return {along(p.x), along(p.y), along(p.z)};
}

std::uint64_t ModelBorder::key(const Cell& c) {
  const auto part = [](std::int64_t v) { return static_cast<std::uint64_t>(v) & 0x1F'FFFF; };
  return part(c[0]) | part(c[1]) << 21 | part(c[2]) << 42;
}

// Mostly there is one in the cell of the point itself.
bool ModelBorder::is_near(Vec3f p) const {
  if (const auto at = cells_.find(key(cell(p))); at != cells_.end())
    for (const BorderPoint& point : at->second)
      if (const Vec3f d = point.position - p; dot(d, d) <= reach_ * reach_) return true;
  return nearest(p) != nullptr;
}

const BorderPoint* ModelBorder::nearest(Vec3f p) const {
  const Cell lo = cell({p.x - reach_, p.y - reach_, p.z - reach_}),
             hi = cell({p.x + reach_, p.y + reach_, p.z + reach_});
  const BorderPoint* best = nullptr;
  float least = reach_ * reach_;
  for (std::int64_t z = lo[2]; z <= hi[2]; ++z)
    for (std::int64_t y = lo[1]; y <= hi[1]; ++y)
      for (std::int64_t x = lo[0]; x <= hi[0]; ++x) {
        const auto at = cells_.find(key({x, y, z}));
        if (at == cells_.end()) continue;
        for (const BorderPoint& point : at->second) {
          const Vec3f d = point.position - p;
          if (const float squared = dot(d, d); best ? squared < least : squared <= least)
            least = squared, best = &point;
        }
      }
  return best;
}

}  // namespace lodestone
