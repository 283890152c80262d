#include "experiments/systems/known_step_system.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>

#include "experiments/systems/surface/patch_hierarchy.h"
#include "experiments/systems/surface/welded_surface.h"

namespace lodestone {
namespace {

bool is_moved(Vec3f viewpoint) {
  std::seed_seq bits{std::bit_cast<std::uint32_t>(viewpoint.x), std::bit_cast<std::uint32_t>(viewpoint.y),
                     std::bit_cast<std::uint32_t>(viewpoint.z)};
  return std::mt19937(bits)() & 1;
}

class KnownStep final : public Patches {
 public:
  KnownStep(const Hierarchy& model, Scheduler& /*scheduler*/)
      : cells_(model), surface_(welded_surface(model, "known-step")), places_(surface_.positions) {
    std::vector<Triangle> near_each_other;
    for (const std::uint32_t t : coherent_order(surface_.positions, surface_.triangles))
      near_each_other.push_back(surface_.triangles[t]);
    surface_.triangles = std::move(near_each_other);
  }

  [[nodiscard]] const Hierarchy& hierarchy() const override { return cells_.hierarchy(); }
  [[nodiscard]] bool remakes() const override { return true; }

  [[nodiscard]] std::vector<CellId> select(Vec3f viewpoint, double reach) override {
    const Vec3f way = is_moved(viewpoint) ? step(viewpoint, reach) : Vec3f{};
    for (std::size_t i = 0; i < places_.size(); ++i) places_[i] = surface_.positions[i] + way;
    return cells_.remake({places_, surface_.normals, surface_.triangles});
  }

  [[nodiscard]] DrawnPoints drawn_points() const override { return {surface_.positions, places_}; }

 private:
  // At a right angle to the way to the middle of the model, and to the axis that is farthest from it.
  [[nodiscard]] Vec3f step(Vec3f viewpoint, double reach) const {
    const Box3f& box = cells_.hierarchy().cells.front().bounds;
    const Vec3d ahead = 0.5 * (to_double(box.lo) + to_double(box.hi)) - to_double(viewpoint);
    const Vec3d up = std::abs(ahead.y) <= std::hypot(ahead.x, ahead.z) ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
    const Vec3d side = cross(ahead, up);
    const double size = nearest(viewpoint) / reach;
    return length(side) > 0 ? to_float((size / length(side)) * side) : Vec3f{};
  }

  [[nodiscard]] double nearest(Vec3f viewpoint) const {
    float squared = std::numeric_limits<float>::max();
    for (const Vec3f p : surface_.positions) squared = std::min(squared, dot(p - viewpoint, p - viewpoint));
    return std::sqrt(double{squared});
  }

  PatchHierarchy cells_;
  WeldedSurface surface_;
  std::vector<Vec3f> places_;
};

}  // namespace

LodSystem known_step_system() {
  return patch_system<KnownStep>(
      "the finest level, which steps aside by the tolerance now and then: for measures of pops");
}

}  // namespace lodestone
