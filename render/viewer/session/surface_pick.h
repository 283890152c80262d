// The surface under a point of a picture: a ray against the triangles as they are drawn, morphed, nearest first.
//
// No picture is read back, so that it can follow the pointer; cost is that of the cells that the ray meets. The alpha
// of textures is not looked at: a ray meets the whole of a triangle.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "render/scene/scene_view.h"

namespace lodestone::viewer {

struct SurfacePoint {
  std::size_t model = 0;  // index in Frame::models
  CellId cell;
  int level = 0;
  bool morphing = false;
  std::uint32_t triangle = 0;  // of the cell
  Vec3d point;                 // normalised space of the model
  double way = 0;              // share of the way from the near plane to the far one, the same for all models
};

// The surface of a frame at (x, y), in pixels from the upper left corner (the middle of the first pixel is 0.5); empty for
// the background.
[[nodiscard]] std::optional<SurfacePoint> surface_at(const Frame& frame, double x, double y);

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
