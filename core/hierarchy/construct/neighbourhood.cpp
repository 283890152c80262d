#include "core/hierarchy/construct/neighbourhood.h"

#include <algorithm>
#include <cmath>

#include "core/math/lanes/float4x3.h"
#include "core/spatial/point_triangle.h"

namespace lodestone {
namespace {

constexpr float thin_sine2 = 1e-4f;
constexpr float least_side2 = 1e-30f;  // of a side that has a length in single precision

// Squared distance of o from the segment from the origin to e; e is not zero.
Float4 from_segment(const Float4x3& o, const Float4x3& e) {
  const Float4 t = max(min(dot(o, e) / dot(e, e), all4(1)), Float4{});
  const Float4x3 d{o.x - t * e.x, o.y - t * e.y, o.z - t * e.z};
  return dot(d, d);
}

}  // namespace

bool Neighbourhood::gather(const LevelSurface& surface, const Box3f& box, double reach, std::size_t limit) {
  items_.clear();
  const LevelSurface::Gathered gathered = surface.gather(box, reach, limit, items_);
  tested_ = gathered.tested;
  if (!gathered.complete) return false;
  reach_ = reach;
  middle_ = 0.5 * (to_double(box.lo) + to_double(box.hi));
  corners_.clear();
  groups_.clear();
  double farthest2 = squared_length(to_double(box.hi) - to_double(box.lo));
  for (const SurfaceItem item : items_) {
    corners_.push_back(surface.corners(item));
    for (const Vec3d p : corners_.back()) farthest2 = std::max(farthest2, squared_length(p - middle_));
  }
  slack_ = static_cast<float>(3e-5 * std::sqrt(farthest2));
  for (std::size_t first = 0; first < items_.size(); first += 4) add_group(first);
  return true;
}

void Neighbourhood::add_group(std::size_t first) {
  Group group{};
  const auto put = [](Float4x3& to, std::size_t k, Vec3d v) {
    to.x[k] = static_cast<float>(v.x), to.y[k] = static_cast<float>(v.y), to.z[k] = static_cast<float>(v.z);
  };
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& [a, b, c] = corners_[std::min(first + k, corners_.size() - 1)];
    put(group.corner, k, a - middle_);
    put(group.ab, k, b - a);
    put(group.ac, k, c - a);
  }
  const Float4x3 &u = group.ab, &v = group.ac;
  group.normal = cross(u, v);
  group.thin = !(dot(group.normal, group.normal) > thin_sine2 * dot(u, u) * dot(v, v));
  const Float4x3 w = v - u;
  group.degenerate = !(min(min(dot(u, u), dot(v, v)), dot(w, w)) > all4(least_side2));
  // No point is farther from the sides than the centre of the inscribed circle: half of the least height.
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& [a, b, c] = corners_[std::min(first + k, corners_.size() - 1)];
    const double side2 = std::max({squared_length(b - a), squared_length(c - a), squared_length(c - b)});
    if (group.thin[k] && side2 > 0)
      group.within[k] = static_cast<float>(0.501 * length(cross(b - a, c - a)) / std::sqrt(side2));
  }
  groups_.push_back(group);
}

// Distance from the plane if the foot of the perpendicular lies inside, else from the nearest of three segments; of
// thin triangles always from those.
Float4 Neighbourhood::squared_distances(const Group& group, const Float4x3& p) {
  const Float4x3 &ab = group.ab, &ac = group.ac, ap = p - group.corner, bp = ap - ab, bc = ac - ab;
  const Float4 size = dot(group.normal, group.normal), height = dot(group.normal, ap);
  const Float4 wb = dot(cross(ap, ac), group.normal), wc = dot(cross(ab, ap), group.normal);
  const Int4 inside = (wb >= 0.0f) & (wc >= 0.0f) & (wb + wc <= size);
  const Float4 edges = min(min(from_segment(ap, ab), from_segment(ap, ac)), from_segment(bp, bc));
  const Float4 plane = height * height / size;
  return group.degenerate ? Float4{} : (inside & ~group.thin) ? plane : edges;
}

Neighbourhood::Nearest Neighbourhood::nearest(Vec3d p, std::uint32_t hint) const {
  const auto distance2 = [&](std::uint32_t i) {
    return nearest_on_triangle(p, corners_[i][0], corners_[i][1], corners_[i][2]).squared_distance;
  };
  Nearest best{std::sqrt(distance2(hint)), hint};
  // Distances in single precision select the items that may be nearer.
  const auto bound_of = [&](double distance) { return static_cast<float>(distance) + slack_; };
  float bound = bound_of(best.distance);
  const Vec3f o = to_float(p - middle_);
  const Float4x3 at{all4(o.x), all4(o.y), all4(o.z)};
  for (std::uint32_t g = 0; g < groups_.size(); ++g) {
    const Float4 near = all4(bound) + groups_[g].within;
    const Int4 may = squared_distances(groups_[g], at) < near * near;
    if (equal(may, Int4{})) continue;
    for (std::uint32_t k = 0; k < 4 && 4 * g + k < items_.size(); ++k) {
      if (!may[k] || 4 * g + k == hint) continue;
      const double found = std::sqrt(distance2(4 * g + k));
      if (!(found < best.distance)) continue;
      best = {found, 4 * g + k};
      bound = bound_of(found);
    }
  }
  return best;
}

}  // namespace lodestone
