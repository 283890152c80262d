// Camera paths that follow from a model: around it, down to its surface, along that, and between places around it.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <numbers>
#include <optional>

#include "core/base/error.h"
#include "core/hierarchy/model/hierarchy.h"
#include "core/math/affine.h"
#include "core/mesh/up_axis.h"
#include "render/camera/camera.h"

namespace lodestone {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180;

struct Ray {
  glm::dvec3 origin, direction;  // normalised model space; the direction of unit length
};

bool meets(const Ray& ray, const Box3f& box) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  const double lo[3] = {box.lo.x, box.lo.y, box.lo.z}, hi[3] = {box.hi.x, box.hi.y, box.hi.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis], d = ray.direction[axis];
    if (d == 0) {
      if (o < lo[axis] || o > hi[axis]) return false;
      continue;
    }
    const double a = (lo[axis] - o) / d, b = (hi[axis] - o) / d;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

glm::dvec3 corner(const Cell& cell, const Triangle& triangle, std::size_t k) {
  const Vec3f p = cell.positions[triangle.v[k]];
  return {p.x, p.y, p.z};
}

// Distance along the ray to a triangle (Moeller and Trumbore 1997), either side of it.
std::optional<double> hit(const Ray& ray, const Cell& cell, const Triangle& triangle) {
  const glm::dvec3 a = corner(cell, triangle, 0), ab = corner(cell, triangle, 1) - a,
                   ac = corner(cell, triangle, 2) - a;
  const glm::dvec3 p = glm::cross(ray.direction, ac);
  const double det = glm::dot(ab, p);
  if (det == 0) return {};
  const glm::dvec3 from_a = ray.origin - a, q = glm::cross(from_a, ab);
  const double u = glm::dot(from_a, p) / det, v = glm::dot(ray.direction, q) / det, t = glm::dot(ac, q) / det;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && t > 0)) return {};
  return t;
}

// First triangle of the finest level along the ray, by cells.
std::optional<double> first_hit(const Hierarchy& hierarchy, const Ray& ray) {
  std::optional<double> nearest;
  for (const Cell& cell : hierarchy.cells_of(hierarchy.finest())) {
    if (!meets(ray, cell.bounds)) continue;
    for (const Triangle& triangle : cell.triangles)
      if (const auto t = hit(ray, cell, triangle); t && (!nearest || *t < *nearest)) nearest = t;
  }
  return nearest;
}

// Barycentre of the root's triangle nearest to a point: somewhere on the coarse surface when the middle is hollow.
glm::dvec3 nearest_of_root(const Hierarchy& hierarchy, glm::dvec3 point) {
  const Cell& root = hierarchy.cells.front();
  glm::dvec3 best = point;
  double best_distance = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : root.triangles) {
    const glm::dvec3 middle = (corner(root, triangle, 0) + corner(root, triangle, 1) + corner(root, triangle, 2)) / 3.0;
    if (const double d = glm::length(middle - point); d < best_distance) best = middle, best_distance = d;
  }
  return best;
}

// The point where a ray from outside along -`outwards` first meets the model: aimed at `place` (of the box: 0 is its
// middle, 1 its upper end), or else at the coarse surface nearest to it. The straight way there is free. A ray that
// misses both times (a coarse surface off the fine one) ends at its aim.
Vec3d landing_point(const Hierarchy& hierarchy, glm::dvec3 outwards, glm::dvec3 place = {}) {
  const Box3f& box = hierarchy.cells.front().bounds;
  const glm::dvec3 lo(box.lo.x, box.lo.y, box.lo.z), hi(box.hi.x, box.hi.y, box.hi.z);
  const glm::dvec3 wanted = 0.5 * (lo + hi) + 0.5 * place * (hi - lo);
  const double start = 2 * glm::length(hi - lo) + 1;
  glm::dvec3 aim = wanted;
  for (int attempt = 0; attempt < 2; ++attempt) {
    const Ray ray{aim + start * outwards, -outwards};
    if (const auto t = first_hit(hierarchy, ray)) {
      aim = ray.origin + *t * ray.direction;
      break;
    }
    if (attempt == 0) aim = nearest_of_root(hierarchy, wanted);
  }
  return hierarchy.transform.origin + hierarchy.transform.scale * Vec3d{aim.x, aim.y, aim.z};
}

double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

glm::dvec3 as_glm(Vec3d v) { return {v.x, v.y, v.z}; }

// Unit vector at an azimuth and an elevation, z up.
Vec3d on_sphere(double azimuth, double elevation) {
  return {std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation), std::sin(elevation)};
}

}  // namespace

Sphere bounding_sphere(const Hierarchy& hierarchy) {
  if (hierarchy.cells.empty()) throw InputError("a hierarchy without cells has nothing to look at");
  const Box3f& box = hierarchy.cells.front().bounds;
  const Vec3d lo = hierarchy.transform.to_model(box.lo), hi = hierarchy.transform.to_model(box.hi);
  return {0.5 * (lo + hi), std::max(0.5 * length(hi - lo), 1e-6 * hierarchy.transform.scale)};
}

Vec3d up_of(const Hierarchy& hierarchy) {
  return direction_of(hierarchy.transform.up.axis, bounding_sphere(hierarchy).centre);
}

double distance_to_see(double radius, double vertical_fov, double aspect) {
  const double half = std::atan(std::tan(vertical_fov / 2) * std::min(aspect, 1.0));
  return radius / std::sin(half);
}

std::vector<Camera> orbit_path(const Sphere& sphere, int frames, const Framing& framing) {
  check_frames(frames);
  constexpr double elevation = 20 * radians_per_degree;
  const Affine3d upright = turn_between({0, 0, 1}, framing.up);
  const double distance = distance_to_see(sphere.radius, Camera{}.vertical_fov, framing.aspect);
  std::vector<Camera> path;
  for (int i = 0; i < frames; ++i) {
    const double azimuth = 2 * std::numbers::pi * i / frames;
    path.push_back(
        {sphere.centre + distance * upright.vector(on_sphere(azimuth, elevation)), sphere.centre, framing.up});
  }
  return path;
}

std::vector<Camera> orbit_path(const Hierarchy& hierarchy, int frames, double aspect) {
  return orbit_path(bounding_sphere(hierarchy), frames, {up_of(hierarchy), aspect});
}

// The distance to the landing point falls by the same factor in every frame. The curve is flown while the camera is
// still outside the bounding sphere; the rest is the straight, free way down.
std::vector<Camera> fly_in_path(const Hierarchy& hierarchy, int frames, const Framing& framing) {
  check_frames(frames);
  constexpr double landing_azimuth = -65 * radians_per_degree, landing_elevation = 40 * radians_per_degree;
  constexpr double turn = 75 * radians_per_degree, climb = 15 * radians_per_degree;
  constexpr double last_height = 0.02;  // over the sphere's radius
  const Sphere sphere = bounding_sphere(hierarchy);
  const Affine3d upright = turn_between({0, 0, 1}, framing.up);
  const Vec3d down = upright.vector(on_sphere(landing_azimuth, landing_elevation));
  const Vec3d landing = landing_point(hierarchy, as_glm(down));

  // Any distance beyond two radii from a point of the sphere is outside it.
  const double first = std::max(6.0, 1 + distance_to_see(1, Camera{}.vertical_fov, framing.aspect)), straight_from = 2;
  std::vector<Camera> path;
  for (int i = 0; i < frames; ++i) {
    const double t = frames == 1 ? 0 : static_cast<double>(i) / (frames - 1);
    const double distance = first * std::pow(last_height / first, t);
    const double curve = smooth(std::log(distance / straight_from) / std::log(first / straight_from));
    const Vec3d away = upright.vector(on_sphere(landing_azimuth - turn * curve, landing_elevation - climb * curve));
    path.push_back({landing + distance * sphere.radius * away, landing, framing.up});
  }
  return path;
}

// Places lie on an ellipse half as wide as the model, where a ray from outside and above meets the surface; the curve
// through two dozen of them is smooth where the surface is not.
std::vector<Camera> walk_path(const Hierarchy& hierarchy, int frames, Vec3d up) {
  check_frames(frames);
  constexpr int places = 24;
  constexpr double height = 1.0 / 12, elevation = 60 * radians_per_degree;  // height over the sphere's radius
  const double radius = bounding_sphere(hierarchy).radius;
  const Affine3d upright = turn_between({0, 0, 1}, up);
  std::vector<Vec3d> ground, above;
  for (int i = 0; i <= places; ++i) {
    const double azimuth = 2 * std::numbers::pi * i / places;
    const Vec3d away = upright.vector(on_sphere(azimuth, elevation));
    ground.push_back(landing_point(hierarchy, as_glm(away), 0.5 * as_glm(upright.vector(on_sphere(azimuth, 0)))));
    above.push_back(ground.back() + height * radius * away);
  }
  std::vector<Camera> keys;
  for (int i = 0; i < places; ++i) keys.push_back({above[i], ground[i + 1], up});
  keys.push_back({above[places], ground[1], up});
  return resample_path(keys, frames, "the walk");
}

// Direction and distance swing at rates without a common period. The distance stays above the sphere's radius, as a
// curve through drawn places would not.
std::vector<Camera> wander_path(const Sphere& sphere, int frames, Vec3d up) {
  check_frames(frames);
  const Affine3d upright = turn_between({0, 0, 1}, up);
  std::vector<Camera> path;
  for (int i = 0; i < frames; ++i) {
    const double t = frames == 1 ? 0 : 2 * std::numbers::pi * i / (frames - 1);
    const Vec3d away = upright.vector(on_sphere(1.7 * t + 0.6 * std::sin(2.3 * t), 0.4 + 0.7 * std::sin(1.9 * t + 1)));
    const Vec3d aside = upright.vector(on_sphere(-1.3 * t, std::sin(2.1 * t)));
    const double distance = 1.1 * std::pow(8 / 1.1, 0.5 + 0.5 * std::sin(2.6 * t + 2));
    path.push_back({sphere.centre + distance * sphere.radius * away, sphere.centre + 0.3 * sphere.radius * aside, up});
  }
  return path;
}

const std::vector<std::string>& model_path_names() {
  static const std::vector<std::string> names{"orbit", "fly-in", "walk", "wander"};
  return names;
}

bool is_model_path(const std::string& name) {
  return std::ranges::find(model_path_names(), name) != model_path_names().end();
}

std::vector<Camera> model_path(const std::string& name, const Hierarchy& hierarchy, int frames,
                               const Framing& framing) {
  assert(is_model_path(name));
  if (name == "orbit") return orbit_path(bounding_sphere(hierarchy), frames, framing);
  if (name == "walk") return walk_path(hierarchy, frames, framing.up);
  if (name == "wander") return wander_path(bounding_sphere(hierarchy), frames, framing.up);
  return fly_in_path(hierarchy, frames, framing);
}

std::vector<Camera> fly_in_path(const Hierarchy& hierarchy, int frames, double aspect) {
  return fly_in_path(hierarchy, frames, Framing{up_of(hierarchy), aspect});
}

}  // namespace lodestone
