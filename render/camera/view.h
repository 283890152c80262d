// The view of a camera that the models of a picture share.
#pragma once

#include <array>
#include <span>

#include "core/math/vec3.h"
#include "render/camera/camera.h"
#include "render/camera/placement.h"
#include "render/camera/projection.h"

namespace lodestone {

// The normalised space of a model, placed in the space of the picture, and the model's bounds in it.
struct PlacedBounds {
  Similarity placement;
  Box3f bounds;
};

// The view that the models of a picture share: a camera in the picture's space, in which clip w is measured, and a
// range of depths that contains the models, apart from parts closer to the eye than 1e-4 of a model's extent (or 1e-6
// of the extent of all). Throws InputError for an invalid camera and for one that is too far away.
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

}  // namespace lodestone
