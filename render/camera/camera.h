// Cameras and camera paths, in the model's own space (not normalised).
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/camera/placement.h"
#include "render/lod/selection.h"

namespace lodestone {

struct Camera {
  Vec3d position;  // model space
  Vec3d target;    // looked at; different from position
  Vec3d up{0, 0, 1};
  double vertical_fov = 0.785398163397448;  // radians, in (0, pi)
  friend bool operator==(const Camera&, const Camera&) = default;
};

struct ImageSize {
  int width = 1280, height = 720;
  friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

// Row-major 4x4 from normalised model space (column vectors) to clip space; depth in [-1, 1], near and far chosen from
// the hierarchy's bounds and the camera.
struct ViewProjection {
  std::array<float, 16> m{};
};

// From window coordinates and depth back to distances: clip w is the depth along the view axis. Half the picture's
// width and height are tan_x and tan_y at w = 1.
struct Lens {
  float tan_x = 1, tan_y = 1;
  float near = 0.01f, far = 10;  // as clip w
  friend bool operator==(const Lens&, const Lens&) = default;
};

// The normalised space of a model, placed in the space of the picture, and the model's bounds in it.
struct PlacedBounds {
  Similarity placement;
  Box3f bounds;
};

// What the models of a picture share: a camera in the picture's space, in which clip w is measured, and a range of
// depths that cuts nothing of them, apart from what is closer to the eye than 1e-4 of a model's extent (or 1e-6 of all
// of them together). Throws InputError for a camera that is none or too far away.
class View {
 public:
  View(const Camera& camera, std::span<const PlacedBounds> models, ImageSize size);

  [[nodiscard]] ViewProjection projection(const Similarity& placement) const;
  [[nodiscard]] Vec3f viewpoint(const Similarity& placement) const;    // normalised model space
  [[nodiscard]] Vec3f towards_eye(const Similarity& placement) const;  // along the view axis, a unit vector
  [[nodiscard]] Lens lens() const;

 private:
  std::array<double, 12> turn_{};  // rows: to the right, up, backwards
  Vec3d eye_, forward_;
  double vertical_fov_, aspect_, near_ = 0, far_ = 0;
};

// The same camera in a space with its origin there and `unit` as its unit; the way it looks is kept exactly, however
// far the new origin is away.
[[nodiscard]] Camera in_space(const Camera& camera, Vec3d origin, double unit);

[[nodiscard]] Vec3f viewpoint(const Camera& camera, const Transform& transform);  // normalised model space
// Of a model alone, clip w in units of its normalised space.
[[nodiscard]] ViewProjection view_projection(const Camera& camera, const Hierarchy& hierarchy, ImageSize size);
[[nodiscard]] Frustum frustum_of(const ViewProjection& vp);

// The path through key frames, at equal steps of the key parameter. Throws InputError, naming `keys_of`, where there
// are no keys or the path passes through its target.
[[nodiscard]] std::vector<Camera> resample_path(std::span<const Camera> keys, int frames, const std::string& keys_of);
// Key frames of a JSON file ({"frames": [{"position": [x,y,z], "target": [...], "up": [...], "fov_degrees": 45}]});
// the path is resampled to `frames` cameras at equal steps of the key parameter. Throws FileError / InputError.
[[nodiscard]] std::vector<Camera> read_camera_path(const std::string& file, int frames);
// The key frames alone.
[[nodiscard]] std::vector<Camera> read_camera_keys(const std::string& file);
void write_camera_path(const std::string& file, std::span<const Camera> path);

struct Sphere {
  Vec3d centre;
  double radius = 1;
};
[[nodiscard]] Sphere bounding_sphere(const Hierarchy& hierarchy);  // of the root's bounds, model space

// Once around the sphere at two radii, level with z.
[[nodiscard]] std::vector<Camera> orbit_path(const Sphere& sphere, int frames);
[[nodiscard]] std::vector<Camera> orbit_path(const Hierarchy& hierarchy, int frames);
// From six bounding-sphere radii, along a curve, down to just above the surface.
[[nodiscard]] std::vector<Camera> fly_in_path(const Hierarchy& hierarchy, int frames);

}  // namespace lodestone
