// Movements of a camera by dragging, scrolling and keys, in model space. Plain functions from a camera to a camera.
//
// The result is always a valid camera: if a movement would end in a number that is not finite, in the target itself, or
// beyond single precision, the camera is not changed.
#pragma once

#include <array>

#include "render/camera/camera.h"

namespace lodestone::viewer {

// Finite, not looking at its own place, with a field of view in (0, pi).
[[nodiscard]] bool is_valid(const Camera& camera);

// Moves around the target; angles in radians, positive to the right and upwards. The turn about the axis `up` is
// unlimited, the elevation stops short of the poles.
[[nodiscard]] Camera orbit(const Camera& camera, double yaw, double pitch);

// Turns the direction of view about the camera's own place.
[[nodiscard]] Camera look_around(const Camera& camera, double yaw, double pitch);

// Camera and target move in the plane of the picture, in units of the picture's height at the distance of the target.
[[nodiscard]] Camera pan(const Camera& camera, double right, double up);

// The distance to the target times `factor`, which is positive.
[[nodiscard]] Camera dolly(const Camera& camera, double factor);

// Camera and target move to the right, upwards and forwards, in units of the model.
[[nodiscard]] Camera travel(const Camera& camera, Vec3d step);

// Looks at the point, from `share` of the present distance to it, in (0, 1].
[[nodiscard]] Camera focus(const Camera& camera, Vec3d point, double share = 0.5);

// Farther from the target where the picture is narrower than high, so that what fits its height at aspect 1 fits its
// width; the same camera in all other pictures. `aspect`: width over height, positive.
[[nodiscard]] Camera fitted(const Camera& camera, double aspect);

// The camera on the way between two cameras, t in [0, 1]; exactly `from` at 0 and `to` at 1.
[[nodiscard]] Camera between(const Camera& from, const Camera& to, double t);

// The axes of the scene as the camera sees them, of length 1: to the right, upwards and towards the eye.
[[nodiscard]] std::array<Vec3d, 3> axes_in_view(const Camera& camera);

}  // namespace lodestone::viewer
