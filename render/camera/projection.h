// A projection as plain data: the size of the picture, the matrix, and the lens, frustum and eye that belong to it.
#pragma once

#include <array>
#include <optional>

#include "core/math/vec3.h"

namespace lodestone {

struct ImageSize {
  int width = 1280, height = 720;
  friend bool operator==(const ImageSize&, const ImageSize&) = default;
};
[[nodiscard]] constexpr double aspect_of(ImageSize size) { return static_cast<double>(size.width) / size.height; }

// Row-major 4x4 from normalised model space (column vectors) to clip space; depth in [-1, 1], near and far chosen from
// the hierarchy's bounds and the camera.
struct ViewProjection {
  std::array<float, 16> m{};
};

// Maps window coordinates and depth back to distances: clip w is the depth along the view axis. Half the picture's
// width and height are tan_x and tan_y at w = 1.
struct Lens {
  float tan_x = 1, tan_y = 1;
  float near = 0.01f, far = 10;  // as clip w
  friend bool operator==(const Lens&, const Lens&) = default;
};

// Half-space n.x + d >= 0 of model space (normalised).
struct Plane {
  Vec3f n;
  float d = 0;
};
[[nodiscard]] inline float distance_from(const Plane& plane, Vec3f p) { return dot(plane.n, p) + plane.d; }

// Negative if all of the box is behind the plane, positive if all of it is before it, else 0.
[[nodiscard]] int side_of(const Plane& plane, const Box3f& box);

// Depth in the window, in [0, 1] between near and far plane, of the point of a plane that is seen at (x, y), in pixels
// from the upper left corner: d[0] x + d[1] y + d[2]. Empty for a plane that is seen edge-on.
using DepthOfPlane = std::array<double, 3>;
[[nodiscard]] std::optional<DepthOfPlane> depth_of_plane(const ViewProjection& vp, const Plane& plane, ImageSize size);

using Frustum = std::array<Plane, 6>;

[[nodiscard]] Frustum frustum_of(const ViewProjection& vp);

// True if the box, grown by `margin` on every side, is entirely outside one of the planes.
[[nodiscard]] bool is_outside(const Frustum& frustum, const Box3f& box, float margin);

// The point at / w, or for w = 0 the direction `at` towards an eye infinitely far away. A point p lies on the eye's
// side of the plane through a with normal n when dot(n, at - w a) > 0.
struct Eye {
  Vec3f at{0, 0, 1};
  float w = 0;
};

// The eye in the space that the projection maps to clip space. For a matrix that is not a camera's, any finite result.
[[nodiscard]] Eye eye_of(const ViewProjection& projection);

}  // namespace lodestone
