// Cameras and camera paths, in the model's own space (not normalised).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/hierarchy/hierarchy.h"
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

[[nodiscard]] Vec3f viewpoint(const Camera& camera, const Transform& transform);  // normalised model space
[[nodiscard]] ViewProjection view_projection(const Camera& camera, const Hierarchy& hierarchy, ImageSize size);
[[nodiscard]] Frustum frustum_of(const ViewProjection& vp);

// Key frames of a JSON file ({"frames": [{"position": [x,y,z], "target": [...], "up": [...], "fov_degrees": 45}]});
// the path is resampled to `frames` cameras at equal steps of the key parameter. Throws FileError / InputError.
[[nodiscard]] std::vector<Camera> read_camera_path(const std::string& file, int frames);
void write_camera_path(const std::string& file, std::span<const Camera> path);

// Once around the model at two bounding-sphere radii.
[[nodiscard]] std::vector<Camera> orbit_path(const Hierarchy& hierarchy, int frames);
// From six bounding-sphere radii, along a curve, down to just above the surface.
[[nodiscard]] std::vector<Camera> fly_in_path(const Hierarchy& hierarchy, int frames);

}  // namespace lodestone
