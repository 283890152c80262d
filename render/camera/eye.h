// Where a projection looks from.
#pragma once

#include "render/camera/camera.h"

namespace lodestone {

// The point at / w, or for w = 0 the direction `at` towards an eye infinitely far away. A point p lies on the eye's
// side of the plane through a with normal n when dot(n, at - w a) > 0.
struct Eye {
  Vec3f at{0, 0, 1};
  float w = 0;
};

// In the space that the projection takes to clip space. Of a matrix that is no camera's, anything finite.
[[nodiscard]] Eye eye_of(const ViewProjection& projection);

}  // namespace lodestone
