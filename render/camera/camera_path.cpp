// Camera paths: key frames in JSON, once around the model, and a flight from far away down to its surface.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <numbers>
#include <optional>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "core/files/atomic_file.h"
#include "core/files/json.h"
#include "core/files/text_file.h"
#include "core/hierarchy/model/hierarchy.h"
#include "core/math/affine.h"
#include "core/mesh/up_axis.h"
#include "render/camera/camera.h"

namespace lodestone {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr int most_frames = 1'000'000;  // catches a mistyped number before it becomes memory

void check_frames(int frames) {
  if (frames < 1 || frames > most_frames)
    throw InputError("a camera path needs between 1 and " + std::to_string(most_frames) + " frames");
}

// ---- JSON ----

double number(const Json& value, const std::string& file, const std::string& place) {
  if (!value.is_number()) throw InputError(describe(file, place, "is not a number"));
  return value.get<double>();
}

Vec3d vector(const Json& value, const std::string& file, const std::string& place) {
  if (!value.is_array() || value.size() != 3)
    throw InputError(describe(file, place, "is not an array of three numbers", "write [x, y, z]"));
  const Vec3d v{number(value[0], file, place), number(value[1], file, place), number(value[2], file, place)};
  constexpr double most = 1e100;  // squares of lengths, and curves between keys, remain finite
  if (std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) > most)
    throw InputError(describe(file, place, "has a coordinate beyond 1e100"));
  return v;
}

// Keys that are not known would be ignored, as misspelt ones are.
void refuse_others(const Json& object, const std::string& file, const std::string& place,
                   const std::vector<std::string>& known) {
  for (const auto& [key, value] : object.items())
    if (std::ranges::find(known, key) == known.end())
      throw InputError(describe(file, place, "unknown key \"" + key + "\"", known_names(key, known)));
}

Camera camera_from(const Json& key, const std::string& file, std::size_t index, Vec3d up) {
  const std::string place = "frame " + std::to_string(index);
  if (!key.is_object()) throw InputError(describe(file, place, "is not an object"));
  refuse_others(key, file, place, {"position", "target", "up", "fov_degrees"});
  Camera camera;
  camera.up = up;
  for (const char* required : {"position", "target"})
    if (!key.contains(required)) throw InputError(describe(file, place, std::string("has no \"") + required + "\""));
  camera.position = vector(key["position"], file, place + ", position");
  camera.target = vector(key["target"], file, place + ", target");
  if (key.contains("up")) camera.up = vector(key["up"], file, place + ", up");
  if (key.contains("fov_degrees")) {
    const double fov = number(key["fov_degrees"], file, place + ", fov_degrees");
    if (!(fov > 0 && fov < 180)) throw InputError(describe(file, place, "fov_degrees must lie between 0 and 180"));
    camera.vertical_fov = fov * degree;
  }
  if (camera.position == camera.target)
    throw InputError(describe(file, place, "position and target are the same point", "move one of them"));
  return camera;
}

Json parse(const std::string& file) {
  try {
    return Json::parse(read_text(file));
  } catch (const JsonError& error) {
    if (error.byte == 0) throw InputError(describe(file, {}, error.what()));
    throw InputError(describe(file, "byte " + std::to_string(error.byte), "is not valid JSON"));
  }
}

// ---- between keys ----

double size_of(double v) { return std::abs(v); }
double size_of(Vec3d v) { return length(v); }

// Way per key at a key between two steps: their mean, the shorter one weighing more. On a line that is the harmonic
// mean of fritsch1984, and 0 where the path turns back, so that nothing is beyond the keys; beside a key that stands it
// is 0.
template <class V>
V speed_between(V before, V after) {
  const double a = size_of(before), b = size_of(after);
  if (!(a > 0 && b > 0)) return {};
  return (b / (a + b)) * before + (a / (a + b)) * after;
}

// A cubic between the keys k and k + 1 (Hermite); values(i) are those of the keys, t the share of the way.
template <class V, class Values>
V cubic_at(const Values& values, std::size_t keys, std::size_t k, double t) {
  const auto step = [&](std::size_t i) -> V { return values(i + 1) + -1.0 * values(i); };
  const V here = step(k);
  const bool first = k == 0, last = k + 2 == keys;
  V from = first ? here : speed_between(step(k - 1), here), to = last ? here : speed_between(here, step(k + 1));
  // At an end of the path the curve is bent evenly.
  if (first && !last) from = 1.5 * here + -0.5 * to;
  if (last && !first) to = 1.5 * here + -0.5 * from;
  return values(k) + (t * t * (3 - 2 * t)) * here + (t * (1 - t) * (1 - t)) * from + (t * t * (t - 1)) * to;
}

// ---- where to look and where to land ----

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

// The point where a ray from outside along -`outwards` first meets the model: aimed at the middle, or else at the
// coarse surface. The straight way there is free. A ray that misses both times (a coarse surface off the fine one) ends
// at its aim.
Vec3d landing_point(const Hierarchy& hierarchy, glm::dvec3 outwards) {
  const Box3f& box = hierarchy.cells.front().bounds;
  const glm::dvec3 lo(box.lo.x, box.lo.y, box.lo.z), hi(box.hi.x, box.hi.y, box.hi.z), middle = 0.5 * (lo + hi);
  const double start = 2 * glm::length(hi - lo) + 1;
  glm::dvec3 aim = middle;
  for (int attempt = 0; attempt < 2; ++attempt) {
    const Ray ray{aim + start * outwards, -outwards};
    if (const auto t = first_hit(hierarchy, ray)) {
      aim = ray.origin + *t * ray.direction;
      break;
    }
    if (attempt == 0) aim = nearest_of_root(hierarchy, middle);
  }
  return hierarchy.transform.origin + hierarchy.transform.scale * Vec3d{aim.x, aim.y, aim.z};
}

double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// Unit vector at an azimuth and an elevation, z up.
Vec3d on_sphere(double azimuth, double elevation) {
  return {std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation), std::sin(elevation)};
}

}  // namespace

Camera camera_at(std::span<const Camera> keys, double place) {
  const std::size_t last = keys.size() - 1;
  const auto k = static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(last)));
  const double t = place - static_cast<double>(k);
  if (k == last || !(t > 0)) return keys[k];
  const auto at = [&]<class V>(V Camera::*member) {
    return cubic_at<V>([&](std::size_t i) { return keys[i].*member; }, keys.size(), k, t);
  };
  return {at(&Camera::position), at(&Camera::target), at(&Camera::up), at(&Camera::vertical_fov)};
}

std::vector<Camera> resample_path(std::span<const Camera> keys, int frames, const std::string& keys_of) {
  check_frames(frames);
  if (keys.empty()) throw InputError(describe(keys_of, {}, "holds no camera"));
  std::vector<Camera> path;
  for (int i = 0; i < frames; ++i) {
    const double at = frames == 1 ? 0 : static_cast<double>(i) * static_cast<double>(keys.size() - 1) / (frames - 1);
    path.push_back(camera_at(keys, at));
    if (const auto key = static_cast<std::size_t>(at); path.back().position == path.back().target)
      throw InputError(describe(keys_of, "between frames " + std::to_string(key) + " and " + std::to_string(key + 1),
                                "the position passes through the target", "add a frame between them"));
  }
  return path;
}

std::vector<Camera> read_camera_keys(const std::string& file, Vec3d up) {
  const Json document = parse(file);
  if (document.is_object()) refuse_others(document, file, {}, {"frames"});
  if (!document.is_object() || !document.contains("frames") || !document["frames"].is_array())
    throw InputError(describe(file, {}, "has no array \"frames\""));
  std::vector<Camera> keys;
  for (const Json& key : document["frames"]) keys.push_back(camera_from(key, file, keys.size(), up));
  if (keys.empty()) throw InputError(describe(file, {}, "\"frames\" is empty", "give at least one camera"));
  return keys;
}

std::vector<Camera> read_camera_path(const std::string& file, int frames, Vec3d up) {
  check_frames(frames);
  return resample_path(read_camera_keys(file, up), frames, file);
}

void write_camera_path(const std::string& file, std::span<const Camera> path) {
  const auto array = [](Vec3d v) { return Json::array({v.x, v.y, v.z}); };
  Json frames = Json::array();
  for (const Camera& camera : path)
    frames.push_back({{"position", array(camera.position)},
                      {"target", array(camera.target)},
                      {"up", array(camera.up)},
                      {"fov_degrees", camera.vertical_fov / degree}});
  const std::string text = Json{{"frames", frames}}.dump(1) + '\n';
  AtomicFile out(file);
  out.write(std::as_bytes(std::span(text)));
  out.commit();
}

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
  constexpr double elevation = 20 * degree;
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
  constexpr double landing_azimuth = -65 * degree, landing_elevation = 40 * degree;
  constexpr double turn = 75 * degree, climb = 15 * degree;
  constexpr double last_height = 0.02;  // over the sphere's radius
  const Sphere sphere = bounding_sphere(hierarchy);
  const Affine3d upright = turn_between({0, 0, 1}, framing.up);
  const Vec3d down = upright.vector(on_sphere(landing_azimuth, landing_elevation));
  const Vec3d landing = landing_point(hierarchy, {down.x, down.y, down.z});

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

std::vector<Camera> fly_in_path(const Hierarchy& hierarchy, int frames, double aspect) {
  return fly_in_path(hierarchy, frames, Framing{up_of(hierarchy), aspect});
}

}  // namespace lodestone
