// A pinhole camera as a matrix. Everything is computed in double and rounded once at the end, so that
// equal cameras give equal bits whatever called before.
#include "render/camera/view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/hierarchy/model/hierarchy.h"
#include "render/camera/placement.h"

namespace lodestone {
namespace {

// Nearest distance of the near plane, over the extent of the bounds: what a float depth buffer still resolves.
constexpr double least_near = 1e-4;
constexpr double least_near_of_all = 1e-6;  // over the extent of all models
// The bounds are float32 and so is the matrix: far is this much, relatively, beyond the last corner.
constexpr double far_guard = 1e-3;
// From far away depths lie at most this many extents of a model before and beyond it: the resolution of a depth buffer
// is spent on the model, not on the way to it.
constexpr double most_room = 1;
// In a range as wide as this the surface before the far plane lies within the rounding of clip coordinates from it, and
// parts of it would be cut off. The plane moves away, which costs nothing: the resolution of depths follows from the
// near plane.
constexpr double wide_range = 5e-5;  // near over far; no camera has it for a single model
constexpr double far_away = 1e3;     // over far: what is left between depth and clip w is twice near

glm::dvec3 to_glm(Vec3d v) { return {v.x, v.y, v.z}; }

// Radians; of a hundred pixels each is then ten times the rounding of a direction. A model that fills the picture may
// be 1e12 times its size away.
constexpr double least_fov = 1e-12;

void check(const Camera& camera) {
  if (!is_finite(camera.position) || !is_finite(camera.target) || !is_finite(camera.up))
    throw InputError(describe({}, "camera", "position, target and up must be finite numbers"));
  if (camera.target == camera.position)
    throw InputError(describe({}, "camera", "position and target are the same point", "move one of them"));
  if (!(camera.vertical_fov > 0 && camera.vertical_fov < std::numbers::pi))
    throw InputError(describe({}, "camera", "the vertical field of view must lie between 0 and 180 degrees"));
  if (camera.vertical_fov < least_fov)
    throw InputError(describe({}, "camera", "its field of view is too narrow for directions in double precision",
                              "widen it, and move the camera towards the model"));
}

InputError too_far() {
  return InputError(describe({}, "camera", "it is too far away for single precision", "move it towards the model"));
}

// Distances from the viewpoint must have squares.
Vec3f in_range(Vec3f viewpoint) {
  if (!std::isfinite(dot(viewpoint, viewpoint))) throw too_far();
  return viewpoint;
}

// Unit vector from one point to another; the largest component goes out first, so that no square over- or underflows.
glm::dvec3 direction(Vec3d from, Vec3d to) {
  const Vec3d d = to - from;
  const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  if (!std::isfinite(largest)) throw too_far();
  return glm::normalize(to_glm((1 / largest) * d));
}

// The camera's up, or, where that is zero or parallel to the view, the axis farthest from the view.
glm::dvec3 usable_up(const Camera& camera, glm::dvec3 forward) {
  constexpr double least_sine = 1e-9;
  const glm::dvec3 up = to_glm(camera.up);
  const double length = glm::length(up);
  if (length > 0 && glm::length(glm::cross(forward, up / length)) > least_sine) return up / length;
  const glm::dvec3 a = glm::abs(forward);
  if (a.x <= a.y && a.x <= a.z) return {1, 0, 0};
  return a.y <= a.z ? glm::dvec3{0, 1, 0} : glm::dvec3{0, 0, 1};
}

// The camera's distance from a model's box and how far the box reaches along the view, in the picture's units.
struct Reach {
  double to_box = 0, to_farthest_corner = 0, extent = 0;
};
Reach reach_of(const PlacedBounds& model, Vec3d eye_in_picture, Vec3d forward_in_picture) {
  const Similarity& placement = model.placement;
  const glm::dvec3 eye = to_glm(placement.inverse(eye_in_picture)),
                   forward = to_glm(placement.rotated_back(forward_in_picture));
  const glm::dvec3 lo = to_glm(to_double(model.bounds.lo)), hi = to_glm(to_double(model.bounds.hi));
  Reach reach;
  reach.extent = placement.scale * std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z, 1e-6});
  reach.to_box = placement.scale * glm::length(glm::max(glm::max(lo - eye, eye - hi), glm::dvec3(0)));
  // The corner of the box that is farthest along the view.
  const glm::dvec3 corner{forward.x > 0 ? hi.x : lo.x, forward.y > 0 ? hi.y : lo.y, forward.z > 0 ? hi.z : lo.z};
  reach.to_farthest_corner = placement.scale * glm::dot(corner - eye, forward);
  return reach;
}

// Every point of a box inside the view has at least depth near, its farthest corner less than far.
struct DepthRange {
  double near = 0, far = 0;
};
DepthRange depth_range(std::span<const PlacedBounds> models, Vec3d eye, Vec3d forward, double tan_corner) {
  // A point seen at an angle t off the axis, at a distance of at least to_box, has a depth of at least to_box cos t.
  const double cos_corner = 1 / std::sqrt(1 + tan_corner * tan_corner);
  DepthRange range{std::numeric_limits<double>::infinity(), 0};
  double largest = 0;
  for (const PlacedBounds& model : models) {
    const Reach reach = reach_of(model, eye, forward);
    if (reach.to_farthest_corner < 0 && models.size() > 1) continue;  // behind the eye
    const double nearest = reach.to_box * cos_corner, room = most_room * reach.extent;
    range.near = std::min(range.near, std::max({0.5 * nearest, nearest - room, least_near * reach.extent}));
    range.far = std::max(range.far, reach.to_farthest_corner + std::min(far_guard * reach.to_farthest_corner, room) +
                                        far_guard * reach.extent);
    largest = std::max(largest, reach.extent);
  }
  if (!(range.near < std::numeric_limits<double>::infinity())) range.near = 1;  // nothing before the eye
  range.near = std::max(range.near, least_near_of_all * std::max(largest, range.far));
  if (range.near < wide_range * range.far) range.far *= far_away;
  if (!(range.far > range.near)) range.far = 2 * range.near;
  return range;
}

}  // namespace

Vec3f viewpoint(const Camera& camera, const Transform& transform) {
  if (!is_finite(camera.position))
    throw InputError(describe({}, "camera", "position, target and up must be finite numbers"));
  return in_range(transform.to_normalised(camera.position));
}

View::View(const Camera& camera, std::span<const PlacedBounds> models, ImageSize size)
    : eye_(camera.position), vertical_fov_(camera.vertical_fov) {
  check(camera);
  if (size.width < 1 || size.height < 1) throw InputError("the image must have a positive size");
  // Not from normalised positions: the difference of two far points would lose the direction.
  const glm::dvec3 forward = direction(camera.position, camera.target);
  forward_ = {forward.x, forward.y, forward.z};
  aspect_ = aspect_of(size);
  const double tan_half = std::tan(vertical_fov_ / 2);
  const DepthRange depth = depth_range(models, eye_, forward_, tan_half * std::sqrt(1 + aspect_ * aspect_));
  near_ = depth.near;
  far_ = depth.far;
  const glm::dmat4 turn = glm::lookAt(glm::dvec3(0), forward, usable_up(camera, forward));
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) turn_[static_cast<std::size_t>(4 * row + column)] = turn[column][row];
}

ViewProjection View::projection(const Similarity& placement) const {
  glm::dmat4 turn(1);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) turn[column][row] = turn_[static_cast<std::size_t>(4 * row + column)];
  // The model before the eye, and only then turned: the difference of far points is taken in double.
  glm::dmat4 model(1);
  for (int row = 0; row < 3; ++row) {
    const Vec3d r = placement.scale * placement.rotation[static_cast<std::size_t>(row)];
    model[0][row] = r.x, model[1][row] = r.y, model[2][row] = r.z;
  }
  model[3] = glm::dvec4(to_glm(placement.translation - eye_), 1);
  const glm::dmat4 m = glm::perspectiveRH_NO(vertical_fov_, aspect_, near_, far_) * (turn * model);

  ViewProjection vp;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      vp.m[static_cast<std::size_t>(4 * row + column)] = static_cast<float>(m[column][row]);
  if (!std::ranges::all_of(vp.m, [](float v) { return std::isfinite(v); })) throw too_far();
  return vp;
}

Vec3f View::viewpoint(const Similarity& placement) const { return in_range(to_float(placement.inverse(eye_))); }

Vec3f View::towards_eye(const Similarity& placement) const { return to_float(placement.rotated_back(-1 * forward_)); }

Lens View::lens() const {
  const double tan_y = std::tan(vertical_fov_ / 2);
  return {static_cast<float>(tan_y * aspect_), static_cast<float>(tan_y), static_cast<float>(near_),
          static_cast<float>(far_)};
}

Camera in_space(const Camera& camera, Vec3d origin, double unit) {
  check(camera);
  const glm::dvec3 forward = direction(camera.position, camera.target);
  Camera there = camera;
  there.position = (1 / unit) * (camera.position - origin);
  // At least as far as coordinates are large: the difference keeps its direction.
  const double step =
      std::max({1.0, std::abs(there.position.x), std::abs(there.position.y), std::abs(there.position.z)});
  there.target = there.position + step * Vec3d{forward.x, forward.y, forward.z};
  if (!is_finite(there.position) || !is_finite(there.target)) throw too_far();
  return there;
}

ViewProjection view_projection(const Camera& camera, const Hierarchy& hierarchy, ImageSize size) {
  const PlacedBounds bounds{{}, hierarchy.cells.empty() ? Box3f{{0, 0, 0}, {1, 1, 1}} : hierarchy.cells.front().bounds};
  return View(in_space(camera, hierarchy.transform.origin, hierarchy.transform.scale), std::span(&bounds, 1), size)
      .projection({});
}

}  // namespace lodestone
