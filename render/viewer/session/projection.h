// From pixels to the model and back: points and lines over the picture.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/camera/camera.h"

namespace lodestone::viewer {

// The inverse of a view projection: from a pixel and its depth to normalised model space.
class Unprojection {
 public:
  // A matrix without an inverse gives points that are not finite.
  Unprojection(const ViewProjection& vp, ImageSize size);
  // x and y in pixels from the upper left corner (the middle of the first pixel is 0.5), depth in [0, 1].
  [[nodiscard]] Vec3d operator()(double x, double y, double depth) const;

 private:
  std::array<double, 16> inverse_{};  // row-major
  ImageSize size_;
};

// Where a point of normalised model space lies in the picture, x and y in pixels, z its depth; empty for one that is
// not in front of the near plane.
[[nodiscard]] std::optional<Vec3f> project(const ViewProjection& vp, ImageSize size, Vec3d point);

// A line of a picture, in pixels; `nearness` in (0, 1], 1 the nearest end of all.
struct Line {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  float nearness = 1;
  Vec3f colour{1, 1, 1};
};

// The twelve edges of a box, as far as they lie before the camera. Appended to `lines`, nearness left at 1 / depth.
void project_box(const ViewProjection& vp, ImageSize size, const Box3f& box, Vec3f colour, std::vector<Line>& lines);

// The edges of what another camera sees: its near and far rectangles, and what joins them.
void project_frustum(const ViewProjection& vp, ImageSize size, const ViewProjection& seen, std::vector<Line>& lines);

// Brings nearness into (0, 1].
void normalise_nearness(std::span<Line> lines);

}  // namespace lodestone::viewer
