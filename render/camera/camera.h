// Cameras and camera paths, in the model's own space (not normalised).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "render/camera/projection.h"

namespace lodestone {

struct Hierarchy;

struct Camera {
  Vec3d position;  // model space
  Vec3d target;    // looked at; different from position
  Vec3d up{0, 0, 1};
  double vertical_fov = 0.785398163397448;  // radians, in (0, pi)
  friend bool operator==(const Camera&, const Camera&) = default;
};

// The same camera in a space with its origin there and `unit` as its unit; its direction is kept exactly, however far
// away the new origin is.
[[nodiscard]] Camera in_space(const Camera& camera, Vec3d origin, double unit);

[[nodiscard]] Vec3f viewpoint(const Camera& camera, const Transform& transform);  // normalised model space
// The projection of a single model; clip w is in units of its normalised space.
[[nodiscard]] ViewProjection view_projection(const Camera& camera, const Hierarchy& hierarchy, ImageSize size);

// Throws InputError unless a path can have so many frames: between one and a million.
void check_frames(int frames);

// The camera between key frames, at a place from 0 to their number less one: smooth, through the keys, and never beyond
// them where the path turns back. Between equal keys it is the same camera, bit for bit. There is a key at least.
[[nodiscard]] Camera camera_at(std::span<const Camera> keys, double place);
// The path through key frames, at equal steps of the key parameter. Throws InputError, naming `keys_of`, if there are
// no keys or the path passes through its target.
[[nodiscard]] std::vector<Camera> resample_path(std::span<const Camera> keys, int frames, const std::string& keys_of);
// Key frames of a JSON file ({"frames": [{"position": [x,y,z], "target": [...], "up": [...], "fov_degrees": 45}]});
// the path is resampled to `frames` cameras at equal steps of the key parameter. `up` is that of keys without one.
// Throws FileError / InputError.
[[nodiscard]] std::vector<Camera> read_camera_path(const std::string& file, int frames, Vec3d up = {0, 0, 1});
// The key frames alone.
[[nodiscard]] std::vector<Camera> read_camera_keys(const std::string& file, Vec3d up = {0, 0, 1});
void write_camera_path(const std::string& file, std::span<const Camera> path);

struct Sphere {
  Vec3d centre;
  double radius = 1;
};
[[nodiscard]] Sphere bounding_sphere(const Hierarchy& hierarchy);  // of the root's bounds, model space

// Where a model's up axis points, in its own space.
[[nodiscard]] Vec3d up_of(const Hierarchy& hierarchy);

// The up axis of a path of cameras, and the aspect of its pictures.
struct Framing {
  Vec3d up{0, 0, 1};  // a unit vector
  double aspect = 1;  // width over height
};
// The distance at which a sphere just fits into a picture: its radius over the sine of half the smaller field of view,
// 2.61 radii at 45 degrees.
[[nodiscard]] double distance_to_see(double radius, double vertical_fov, double aspect);

// Once around the sphere, 20 degrees above its middle, so far away that it is in sight as a whole.
[[nodiscard]] std::vector<Camera> orbit_path(const Sphere& sphere, int frames, const Framing& framing = {});
// From where the bounding sphere is well in sight, at least six radii away, along a curve, down to just above the
// surface.
[[nodiscard]] std::vector<Camera> fly_in_path(const Hierarchy& hierarchy, int frames, const Framing& framing);
// Once around over the surface of a model, a twelfth of its sphere's radius above it, looking ahead.
[[nodiscard]] std::vector<Camera> walk_path(const Hierarchy& hierarchy, int frames, Vec3d up);
// To and fro around the sphere, between 1.1 and 8 of its radii away, looking at points within its inner third.
[[nodiscard]] std::vector<Camera> wander_path(const Sphere& sphere, int frames, Vec3d up);
// These four by name: "orbit", "fly-in", "walk", "wander".
[[nodiscard]] const std::vector<std::string>& model_path_names();
[[nodiscard]] bool is_model_path(const std::string& name);
[[nodiscard]] std::vector<Camera> model_path(const std::string& name, const Hierarchy& hierarchy, int frames,
                                             const Framing& framing);
// Some of the same paths of a model by itself, by its own up axis.
[[nodiscard]] std::vector<Camera> orbit_path(const Hierarchy& hierarchy, int frames, double aspect = 1);
[[nodiscard]] std::vector<Camera> fly_in_path(const Hierarchy& hierarchy, int frames, double aspect = 1);

}  // namespace lodestone
