#include "render/viewer/controls/camera_control.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <numbers>

namespace lodestone::viewer {
namespace {

constexpr double pole_margin = 0.02;  // radians that the direction of view keeps from the axis `up`

glm::dvec3 to_glm(Vec3d v) { return {v.x, v.y, v.z}; }
Vec3d from_glm(glm::dvec3 v) { return {v.x, v.y, v.z}; }

// Right, up and forward of the picture, unit vectors.
struct Axes {
  glm::dvec3 right, up, forward;
};

// Any vector that is not parallel to the direction of view will do where `up` is.
Axes axes_of(const Camera& camera) {
  Axes axes;
  axes.forward = glm::normalize(to_glm(camera.target) - to_glm(camera.position));
  glm::dvec3 side = glm::cross(axes.forward, to_glm(camera.up));
  if (!(glm::length(side) > 1e-9 * glm::length(to_glm(camera.up))))
    side = glm::cross(axes.forward, std::abs(axes.forward.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0));
  axes.right = glm::normalize(side);
  axes.up = glm::cross(axes.right, axes.forward);
  return axes;
}

// The direction of view after a turn: pitch about the picture's right, at most to the poles, then yaw about `up`.
glm::dvec3 turned(const Camera& camera, double yaw, double pitch) {
  const Axes axes = axes_of(camera);
  const glm::dvec3 pole = glm::normalize(to_glm(camera.up));
  const double elevation = std::asin(std::clamp(glm::dot(axes.forward, pole), -1.0, 1.0));
  const double limit = std::numbers::pi / 2 - pole_margin;
  const double lowest = std::min(-limit, elevation), highest = std::max(limit, elevation);
  const double allowed = std::clamp(elevation + pitch, lowest, highest) - elevation;
  return glm::angleAxis(yaw, pole) * (glm::angleAxis(allowed, axes.right) * axes.forward);
}

double distance_of(const Camera& camera) { return length(camera.target - camera.position); }

Camera valid_or(const Camera& moved, const Camera& before) { return is_valid(moved) ? moved : before; }

}  // namespace

bool is_valid(const Camera& camera) {
  if (!is_finite(camera.position) || !is_finite(camera.target) || !is_finite(camera.up)) return false;
  // Far from the origin the two may be different, but not by a length that has digits left.
  const double distance = distance_of(camera), largest = std::max(length(camera.position), length(camera.target));
  return distance > 1e-13 * largest && distance > 0 && distance < 1e30 && length(camera.up) > 0 &&
         camera.vertical_fov > 0 && camera.vertical_fov < std::numbers::pi;
}

// Drawn to the right, the model turns to the right: the camera moves left around it.
Camera orbit(const Camera& camera, double yaw, double pitch) {
  if (!is_valid(camera)) return camera;
  Camera moved = camera;
  moved.position = camera.target - distance_of(camera) * from_glm(turned(camera, -yaw, pitch));
  return valid_or(moved, camera);
}

Camera look_around(const Camera& camera, double yaw, double pitch) {
  if (!is_valid(camera)) return camera;
  Camera moved = camera;
  moved.target = camera.position + distance_of(camera) * from_glm(turned(camera, -yaw, pitch));
  return valid_or(moved, camera);
}

Camera pan(const Camera& camera, double right, double up) {
  const double height = 2 * distance_of(camera) * std::tan(camera.vertical_fov / 2);
  return travel(camera, {right * height, up * height, 0});
}

Camera dolly(const Camera& camera, double factor) {
  if (!is_valid(camera) || !(factor > 0)) return camera;
  Camera moved = camera;
  moved.position = camera.target + factor * (camera.position - camera.target);
  return valid_or(moved, camera);
}

Camera travel(const Camera& camera, Vec3d step) {
  if (!is_valid(camera)) return camera;
  const Axes axes = axes_of(camera);
  const Vec3d way = from_glm(step.x * axes.right + step.y * axes.up + step.z * axes.forward);
  Camera moved = camera;
  moved.position = camera.position + way;
  moved.target = camera.target + way;
  return valid_or(moved, camera);
}

Camera focus(const Camera& camera, Vec3d point, double share) {
  if (!(share > 0)) return camera;
  Camera moved = camera;
  moved.target = point;
  moved.position = point + share * (camera.position - point);
  return valid_or(moved, camera);
}

Camera fitted(const Camera& camera, double aspect) {
  if (!(aspect < 1)) return camera;
  // A sphere fits at a distance of its radius over the sine of half the angle of view.
  const double half = 0.5 * camera.vertical_fov, half_across = std::atan(aspect * std::tan(half));
  return dolly(camera, std::sin(half) / std::sin(half_across));
}

Camera between(const Camera& from, const Camera& to, double t) {
  if (!(t > 0)) return from;
  if (!(t < 1)) return to;
  const auto mix = [t](Vec3d a, Vec3d b) { return (1 - t) * a + t * b; };
  const Camera mixed{mix(from.position, to.position), mix(from.target, to.target), mix(from.up, to.up),
                     (1 - t) * from.vertical_fov + t * to.vertical_fov};
  return valid_or(mixed, to);
}

std::array<Vec3d, 3> axes_in_view(const Camera& camera) {
  const Axes axes = axes_of(camera);
  const auto seen = [&](std::size_t axis) {
    const auto k = static_cast<glm::dvec3::length_type>(axis);
    return Vec3d{axes.right[k], axes.up[k], -axes.forward[k]};
  };
  return {seen(0), seen(1), seen(2)};
}

}  // namespace lodestone::viewer
