#include "core/mesh/up_axis.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/math/affine.h"

namespace lodestone {
namespace {

// An axis across both of two opposite axes.
Vec3d across(Vec3d axis) { return std::abs(axis.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}; }

// With almost opposite vectors the turn is about any axis across.
bool are_opposite(double cosine) { return cosine < -1 + 1e-12; }

}  // namespace

std::string text_of(Up up) { return std::string(name_of(up.axis)) + (up.guessed ? ", guessed by the format" : ""); }

std::string guess_note(Up up) { return up.guessed ? "up is " + text_of(up) + "; --up AXIS gives another" : ""; }

std::optional<UpAxis> up_axis_named(std::string_view name) {
  const auto found = std::ranges::find(up_axis_names, name);
  if (found == up_axis_names.end()) return {};
  return static_cast<UpAxis>(found - up_axis_names.begin());
}

UpAxis up_axis(const std::string& name) {
  const std::optional<UpAxis> axis = up_axis_named(name);
  if (!axis || axis == UpAxis::earth) throw InputError("--up " + name + ": unknown; known are x, y, z, -x, -y, -z");
  return *axis;
}

Vec3d direction_of(UpAxis axis, Vec3d place) {
  switch (axis) {
    case UpAxis::z:
      return {0, 0, 1};
    case UpAxis::y:
      return {0, 1, 0};
    case UpAxis::x:
      return {1, 0, 0};
    case UpAxis::minus_z:
      return {0, 0, -1};
    case UpAxis::minus_y:
      return {0, -1, 0};
    case UpAxis::minus_x:
      return {-1, 0, 0};
    case UpAxis::earth:
      break;
  }
  const double distance = length(place);
  return distance > 0 && std::isfinite(distance) ? (1 / distance) * place : Vec3d{0, 0, 1};
}

// v -> v + k x v + k x (k x v) / (1 + cosine), k the cross product of the two (Rodrigues 1840).
Affine3d turn_between(Vec3d from, Vec3d to) {
  const Vec3d k = cross(from, to);
  const double cosine = dot(from, to);
  Affine3d turn;
  if (from == to) return turn;
  if (are_opposite(cosine)) {
    const Vec3d a = across(from);
    for (Vec3d& axis : turn.axes) axis = 2 * dot(a, axis) * a - axis;
    return turn;
  }
  for (Vec3d& axis : turn.axes) axis = axis + cross(k, axis) + (1 / (1 + cosine)) * cross(k, cross(k, axis));
  return turn;
}

std::array<double, 4> turn_quaternion(Vec3d from, Vec3d to) {
  const double cosine = dot(from, to);
  if (are_opposite(cosine)) {
    const Vec3d a = across(from);
    return {a.x, a.y, a.z, 0};
  }
  const Vec3d k = cross(from, to);
  const double w = 1 + cosine, norm = std::sqrt(dot(k, k) + w * w);
  return {k.x / norm, k.y / norm, k.z / norm, w / norm};
}

}  // namespace lodestone
