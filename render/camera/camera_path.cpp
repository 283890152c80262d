// Camera paths: key frames in JSON, once around the model, and a flight from far away down to its surface.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/hierarchy/model/hierarchy.h"
#include "render/camera/camera.h"

namespace lodestone {
namespace {

using nlohmann::json;

constexpr double degree = std::numbers::pi / 180;
constexpr int most_frames = 1'000'000;  // catches a mistyped number before it becomes memory

void check_frames(int frames) {
  if (frames < 1 || frames > most_frames)
    throw InputError("a camera path needs between 1 and " + std::to_string(most_frames) + " frames");
}

// ---- JSON ----

double number(const json& value, const std::string& file, const std::string& place) {
  if (!value.is_number()) throw InputError(describe(file, place, "is not a number"));
  return value.get<double>();
}

Vec3d vector(const json& value, const std::string& file, const std::string& place) {
  if (!value.is_array() || value.size() != 3)
    throw InputError(describe(file, place, "is not an array of three numbers", "write [x, y, z]"));
  return {number(value[0], file, place), number(value[1], file, place), number(value[2], file, place)};
}

Camera camera_from(const json& key, const std::string& file, std::size_t index) {
  const std::string place = "frame " + std::to_string(index);
  if (!key.is_object()) throw InputError(describe(file, place, "is not an object"));
  Camera camera;
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

json parse(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw FileError(describe(file, {}, "cannot be opened for reading"));
  try {
    return json::parse(in);
  } catch (const json::parse_error& error) {
    throw InputError(describe(file, "byte " + std::to_string(error.byte), "is not valid JSON"));
  } catch (const json::exception&) {  // e.g. a number beyond double
    throw InputError(describe(file, {}, "holds a number out of range"));
  }
}

Camera between(const Camera& a, const Camera& b, double t) {
  const auto mix = [t](Vec3d from, Vec3d to) { return (1 - t) * from + t * to; };
  return {mix(a.position, b.position), mix(a.target, b.target), mix(a.up, b.up),
          (1 - t) * a.vertical_fov + t * b.vertical_fov};
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

std::vector<Camera> resample_path(std::span<const Camera> keys, int frames, const std::string& keys_of) {
  check_frames(frames);
  if (keys.empty()) throw InputError(describe(keys_of, {}, "holds no camera"));
  std::vector<Camera> path;
  for (int i = 0; i < frames; ++i) {
    const double at = frames == 1 ? 0 : static_cast<double>(i) * static_cast<double>(keys.size() - 1) / (frames - 1);
    const auto key = std::min(static_cast<std::size_t>(at), keys.size() - 1);
    const double t = at - static_cast<double>(key);
    path.push_back(t == 0 ? keys[key] : between(keys[key], keys[key + 1], t));
    if (path.back().position == path.back().target)
      throw InputError(describe(keys_of, "between frames " + std::to_string(key) + " and " + std::to_string(key + 1),
                                "the position passes through the target", "add a frame between them"));
  }
  return path;
}

std::vector<Camera> read_camera_keys(const std::string& file) {
  const json document = parse(file);
  if (!document.is_object() || !document.contains("frames") || !document["frames"].is_array())
    throw InputError(describe(file, {}, "has no array \"frames\""));
  std::vector<Camera> keys;
  for (const json& key : document["frames"]) keys.push_back(camera_from(key, file, keys.size()));
  if (keys.empty()) throw InputError(describe(file, {}, "\"frames\" is empty", "give at least one camera"));
  return keys;
}

std::vector<Camera> read_camera_path(const std::string& file, int frames) {
  check_frames(frames);
  return resample_path(read_camera_keys(file), frames, file);
}

void write_camera_path(const std::string& file, std::span<const Camera> path) {
  const auto array = [](Vec3d v) { return json::array({v.x, v.y, v.z}); };
  json frames = json::array();
  for (const Camera& camera : path)
    frames.push_back({{"position", array(camera.position)},
                      {"target", array(camera.target)},
                      {"up", array(camera.up)},
                      {"fov_degrees", camera.vertical_fov / degree}});
  const std::string text = json{{"frames", frames}}.dump(1) + '\n';
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

std::vector<Camera> orbit_path(const Sphere& sphere, int frames) {
  check_frames(frames);
  constexpr double elevation = 20 * degree;
  std::vector<Camera> path;
  for (int i = 0; i < frames; ++i) {
    const double azimuth = 2 * std::numbers::pi * i / frames;
    path.push_back({sphere.centre + 2 * sphere.radius * on_sphere(azimuth, elevation), sphere.centre});
  }
  return path;
}

std::vector<Camera> orbit_path(const Hierarchy& hierarchy, int frames) {
  return orbit_path(bounding_sphere(hierarchy), frames);
}

// The distance to the landing point falls by the same factor in every frame. The curve is flown while the camera is
// still outside the bounding sphere; the rest is the straight, free way down.
std::vector<Camera> fly_in_path(const Hierarchy& hierarchy, int frames) {
  check_frames(frames);
  constexpr double landing_azimuth = -65 * degree, landing_elevation = 40 * degree;
  constexpr double turn = 75 * degree, climb = 15 * degree;
  constexpr double last_height = 0.02;  // over the sphere's radius
  const Sphere sphere = bounding_sphere(hierarchy);
  const Vec3d down = on_sphere(landing_azimuth, landing_elevation);
  const Vec3d landing = landing_point(hierarchy, {down.x, down.y, down.z});

  // Any distance beyond two radii from a point of the sphere is outside it.
  const double first = 6, straight_from = 2;
  std::vector<Camera> path;
  for (int i = 0; i < frames; ++i) {
    const double t = frames == 1 ? 0 : static_cast<double>(i) / (frames - 1);
    const double distance = first * std::pow(last_height / first, t);
    const double curve = smooth(std::log(distance / straight_from) / std::log(first / straight_from));
    const Vec3d away = on_sphere(landing_azimuth - turn * curve, landing_elevation - climb * curve);
    path.push_back({landing + distance * sphere.radius * away, landing});
  }
  return path;
}

}  // namespace lodestone
