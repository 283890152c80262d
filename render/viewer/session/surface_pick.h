// The surface under a point of a picture: a ray against the triangles as they are drawn, morphed.
//
// It is the surface that the pixel shows most of: the nearest one where all are opaque, not a hole of a mask, and of
// several layers the one with the largest share. The cut of a solid by the clipping plane is one, too.
//
// No picture is read back, so that it can follow the pointer; cost is that of the cells that the ray meets.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "render/scene/scene_view.h"
#include "render/viewer/session/surface_alpha.h"

namespace lodestone::viewer {

struct SurfacePoint {
  std::size_t model = 0;  // index in Frame::models
  CellId cell;
  int level = 0;
  bool morphing = false;
  std::uint32_t triangle = 0;  // of the cell
  Vec3d point;                 // normalised space of the model
  double way = 0;              // share of the way from the near plane to the far one, the same for all models
  bool cut = false;            // the point lies on the cut of a solid, the triangle behind it
};

// The surface of a frame at (x, y), in pixels from the upper left corner (the middle of the first pixel is 0.5); empty
// for the background. `alpha` is prepared for the frame.
[[nodiscard]] std::optional<SurfacePoint> surface_at(const Frame& frame, const SurfaceAlpha& alpha, double x, double y);

// Facts about it for people.
struct SurfaceFacts {
  std::string model;  // its name
  CellId cell;
  int level = 0;
  bool morphing = false;
  std::size_t triangles = 0;  // of the cell
  double error = 0;           // that the cell has stored, in units of the scene
  double error_pixels = 0;    // as it is seen at the point's distance
  bool measured = false;      // the error is a bound, not an estimate
  Vec3d point;                // in the scene
};
[[nodiscard]] SurfaceFacts facts_of(const SurfacePoint& surface, const SceneView& scene, const Camera& camera);

}  // namespace lodestone::viewer
