#include "render/viewer/controls/looks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/mesh/up_axis.h"
#include "render/viewer/controls/in_range.h"

namespace lodestone::viewer {
namespace {

constexpr double degree = std::numbers::pi / 180;

void clamp_colour(Vec3f& colour, Vec3f fallback) {
  colour = {in_range(colour.x, 0, 1, fallback.x), in_range(colour.y, 0, 1, fallback.y),
            in_range(colour.z, 0, 1, fallback.z)};
}

// Three unit vectors at right angles: across, across, and `up` itself.
std::array<Vec3d, 3> frame_about(Vec3d up) {
  const double along = length(up);
  const Vec3d pole = along > 0 ? (1 / along) * up : Vec3d{0, 0, 1};
  const Vec3d other = std::abs(pole.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d side = other - dot(other, pole) * pole;
  const Vec3d first = (1 / length(side)) * side;
  return {first, cross(pole, first), pole};
}

}  // namespace

Looks looks_of(const Scene& scene) {
  const FrameSettings& settings = scene.settings;
  Looks looks;
  looks.lighting = settings.lighting;
  looks.towards_light = scene.towards_light;
  looks.background = settings.background;
  looks.fog = settings.fog;
  looks.ambient_occlusion = settings.ambient_occlusion;
  return looks;
}

Looks clamped(Looks looks) {
  const Looks usual;
  constexpr float strongest = 10;
  Lighting& light = looks.lighting;
  light.ambient = in_range(light.ambient, 0, 1, usual.lighting.ambient);
  light.head = in_range(light.head, 0, strongest, usual.lighting.head);
  light.directional.strength = in_range(light.directional.strength, 0, strongest, usual.lighting.directional.strength);
  if (!is_finite(looks.towards_light) || !(length(looks.towards_light) > 0)) looks.towards_light = usual.towards_light;
  clamp_colour(looks.background, usual.background);
  clamp_colour(looks.fog.colour, usual.fog.colour);
  looks.fog.density = in_range(looks.fog.density, 0, 1e30f, 0);
  looks.ambient_occlusion.strength = in_range(looks.ambient_occlusion.strength, 0, 1, 0);
  looks.ambient_occlusion.radius = in_range(looks.ambient_occlusion.radius, 0, 1e30f, 0);
  return looks;
}

Bearing bearing_of(Vec3d direction, Vec3d up) {
  if (!(length(direction) > 0)) return {};
  const auto [first, second, pole] = frame_about(up);
  const double x = dot(direction, first), y = dot(direction, second), z = dot(direction, pole);
  return {std::atan2(y, x) / degree, std::atan2(z, std::hypot(x, y)) / degree};
}

Vec3d direction_of(Bearing bearing, Vec3d up) {
  const auto [first, second, pole] = frame_about(up);
  const double around = bearing.around * degree, above = bearing.above * degree;
  return std::cos(above) * (std::cos(around) * first + std::sin(around) * second) + std::sin(above) * pole;
}

void show(Looks& looks, std::size_t model, bool shown) {
  if (looks.hidden.size() <= model) looks.hidden.resize(model + 1, false);
  looks.hidden[model] = !shown;
}

}  // namespace lodestone::viewer
