#include "render/lod/normal_cones.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace lodestone {
namespace {

// Cosines are computed in double and stored in float.
constexpr double stored_guard = 1e-5;
// Sine of what counts as seen from the side.
constexpr float side = 0.02f;

using Corners = std::array<Vec3d, 3>;

// Unit normal; nothing for a triangle of no area. Differences of floats are exact in double here, so that a cross
// product is off by about 1e-16 of the edges' lengths: a product below 1e-13 of them is noise and counts as no area.
std::optional<Vec3d> unit_normal(const Corners& p) {
  const Vec3d a = p[1] - p[0], b = p[2] - p[0], n = cross(a, b);
  const double norm2 = dot(n, n);
  if (!(norm2 > 1e-26 * dot(a, a) * dot(b, b)) || !(norm2 > 0)) return std::nullopt;
  return (1 / std::sqrt(norm2)) * n;
}

// A cone about an axis that is chosen first.
class ConeAbout {
 public:
  explicit ConeAbout(Vec3d axis) : axis_(axis) {}
  void add(const Corners& corners) {
    if (const auto n = unit_normal(corners)) least_cosine_ = std::min(least_cosine_, dot(axis_, *n));
  }
  [[nodiscard]] bool holds_all() const { return !(least_cosine_ > stored_guard); }
  [[nodiscard]] NormalCone cone() const {
    if (holds_all()) return {};
    const double cosine = least_cosine_ - stored_guard;
    return {to_float(axis_), static_cast<float>(std::sqrt(1 - cosine * cosine) + stored_guard)};
  }

 private:
  Vec3d axis_;
  double least_cosine_ = 1;
};

Vec3d towards(Vec3d v) {
  const double length2 = dot(v, v);
  return length2 > 0 ? (1 / std::sqrt(length2)) * v : Vec3d{0, 0, 1};
}

Corners corners_of(const Cell& cell, const Triangle& t) {
  return {to_double(cell.positions[t.v[0]]), to_double(cell.positions[t.v[1]]), to_double(cell.positions[t.v[2]])};
}

// The middle of the box around the unit normals: near the axis of the least cone, and found in one pass.
Vec3d axis_of(const Cell& cell) {
  Vec3d lo{2, 2, 2}, hi{-2, -2, -2};
  for (const Triangle& t : cell.triangles) {
    const auto n = unit_normal(corners_of(cell, t));
    if (!n) continue;
    lo = {std::min(lo.x, n->x), std::min(lo.y, n->y), std::min(lo.z, n->z)};
    hi = {std::max(hi.x, n->x), std::max(hi.y, n->y), std::max(hi.z, n->z)};
  }
  return lo.x > hi.x ? Vec3d{0, 0, 1} : towards(lo + hi);
}

// Adds the states in which some corners, not none, are at their parents' places.
void add_states(const Cell& cell, const Cell& coarser, const Triangle& t, ConeAbout& cone) {
  const Corners own = corners_of(cell, t);
  for (unsigned state = 1; state < 8; ++state) {
    Corners p = own;
    for (std::size_t k = 0; k < 3; ++k)
      if (state >> k & 1) p[k] = to_double(coarser.positions[cell.parents[t.v[k]]]);
    cone.add(p);
  }
}

NormalCone still_cone(const Cell& cell, Vec3d axis) {
  ConeAbout cone(axis);
  for (const Triangle& t : cell.triangles) {
    cone.add(corners_of(cell, t));
    if (cone.holds_all()) break;
  }
  return cone.cone();
}

NormalCone morphing_cone(const Cell& cell, const Cell* coarser, Vec3d axis) {
  ConeAbout cone(axis);
  for (const Triangle& t : cell.triangles) {
    cone.add(corners_of(cell, t));
    if (coarser) add_states(cell, *coarser, t, cone);
    if (cone.holds_all()) break;
  }
  return cone.cone();
}

double angle_of(const NormalCone& cone) { return std::asin(std::min(double{cone.sine}, 1.0)); }

// The axis halves the angle between the outermost directions of both.
NormalCone cone_of_both(const NormalCone& a, const NormalCone& b) {
  if (a.sine == NormalCone::holds_all || b.sine == NormalCone::holds_all) return {};
  const Vec3d from = to_double(a.axis), to = to_double(b.axis);
  const double apart = std::acos(std::clamp(dot(from, to), -1.0, 1.0)), of_a = angle_of(a), of_b = angle_of(b);
  if (apart + of_b <= of_a) return a;
  if (apart + of_a <= of_b) return b;
  const double angle = (of_a + apart + of_b) / 2 + stored_guard, turn = angle - of_a;
  const Vec3d across = to - dot(from, to) * from;
  if (angle >= std::acos(stored_guard) || !(dot(across, across) > 1e-12)) return {};
  const Vec3d axis = std::cos(turn) * from + std::sin(turn) * towards(across);
  return {to_float(towards(axis)), static_cast<float>(std::sin(angle) + stored_guard)};
}

}  // namespace

// (p - v) . axis >= (sine + side) |p - v| for the whole box: the difference is concave in p, so that corners decide.
bool turns_its_back(const NormalCone& cone, Vec3f viewpoint, const Box3f& box) {
  const float sine = cone.sine + side;
  if (!(sine < 1)) return false;
  for (int k = 0; k < 8; ++k) {
    const Vec3f p{(k & 1) ? box.hi.x : box.lo.x, (k & 2) ? box.hi.y : box.lo.y, (k & 4) ? box.hi.z : box.lo.z};
    const Vec3f d = p - viewpoint;
    if (!(dot(d, cone.axis) > sine * std::sqrt(dot(d, d)))) return false;
  }
  return true;
}

NormalCones::NormalCones(const Hierarchy& hierarchy, Scheduler& scheduler) : cones_(hierarchy.cells.size()) {
  scheduler.for_chunks(hierarchy.cells.size(), 1, [&](ChunkRange range) {
    for (std::size_t c = range.begin; c < range.end; ++c) {
      const Cell& cell = hierarchy.cells[c];
      const Cell* const coarser = cell.parent == no_cell ? nullptr : &hierarchy.cells[cell.parent];
      if (cell.positions.empty() || (coarser && coarser->positions.empty())) continue;
      const Vec3d axis = axis_of(cell);
      cones_[c].still = still_cone(cell, axis);
      if (cones_[c].still.sine != NormalCone::holds_all) cones_[c].morphing = morphing_cone(cell, coarser, axis);
    }
  });
  for (std::size_t c = cones_.size(); c-- > 0;) {
    const Cell& cell = hierarchy.cells[c];
    cones_[c].subtree = cones_[c].morphing;
    for (CellId k = cell.first_child; k < cell.end_child(); ++k)
      cones_[c].subtree = cone_of_both(cones_[c].subtree, cones_[k].subtree);
  }
}

void NormalCones::turn_over() {
  for (Cones& cones : cones_)
    for (NormalCone* cone : {&cones.still, &cones.morphing, &cones.subtree}) cone->axis = -1.0f * cone->axis;
}

}  // namespace lodestone
