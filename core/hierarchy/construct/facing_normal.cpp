#include "core/hierarchy/construct/facing_normal.h"

#include <algorithm>
#include <cstddef>
#include <functional>

namespace lodestone {
namespace {

constexpr double far_cosine = 0.5;    // 60 degrees
constexpr double near_cosine = 0.55;  // near enough, with room for the rounding of packed normals
constexpr int steps = 16;             // 32 leave as much area over 60 degrees, within a tenth of it

struct Facing {
  Vec3d normal;  // of unit length
  double area = 0;
};

double least_cosine(const std::vector<Facing>& all, Vec3d n, Vec3d& farthest) {
  double least = 2;
  for (const Facing& f : all) {
    const double cosine = dot(f.normal, n);
    if (cosine < least) least = cosine, farthest = f.normal;
  }
  return least;
}

constexpr double rounding = 1e-9;  // of opposite normals any direction is as good as the mean, which is kept

// The best of some steps from the mean towards the centre of the smallest cap that holds all.
Vec3d centre_of(const std::vector<Facing>& all) {
  Vec3d n{}, best{}, farthest{};
  for (const Facing& f : all) n = n + f.area * f.normal;
  double best_cosine = -2;
  for (int step = 0; step < steps && best_cosine < near_cosine; ++step) {
    if (!(length(n) > 0)) n = all.front().normal;
    n = (1 / length(n)) * n;
    const double cosine = least_cosine(all, n, farthest);
    if (cosine > best_cosine + rounding) best_cosine = cosine, best = n;
    n = n + (1.0 / (step + 2)) * (farthest - n);
  }
  return best;
}

}  // namespace

Vec3d facing_normal(const std::vector<Vec3d>& triangles) {
  std::vector<Facing> all;
  for (const Vec3d& t : triangles)
    if (const double area = length(t); area > 0) all.push_back({(1 / area) * t, area});
  if (all.empty()) return {};
  for (;;) {
    const Vec3d n = centre_of(all);
    const auto far =
        std::stable_partition(all.begin(), all.end(), [&](const Facing& f) { return dot(f.normal, n) >= far_cosine; });
    if (far == all.end()) return n;
    // One by one, but an eighth of many: thousands may meet at the tip of a cone.
    const auto given_up = std::max<std::ptrdiff_t>(1, (all.end() - far) / 8);
    std::ranges::nth_element(far, all.end() - given_up, all.end(), std::greater{}, &Facing::area);
    all.resize(all.size() - static_cast<std::size_t>(given_up));
  }
}

}  // namespace lodestone
