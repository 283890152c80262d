// An image drawn anew for other texture coordinates than its own.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "core/math/vec3.h"
#include "core/mesh/attributes.h"
#include "core/texture/downsample.h"

namespace lodestone {

// A triangle of the surface that shows the image.
struct RedrawTriangle {
  std::array<Vec2f, 3> from, to;     // coordinates in the image, and in the one to be made
  std::array<Vec3f, 3> positions{};  // for the directions of normals in tangent space
};

[[nodiscard]] inline double doubled_area(const std::array<Vec2f, 3>& p) {
  return std::abs((double{p[1].x} - p[0].x) * (double{p[2].y} - p[0].y) -
                  (double{p[2].x} - p[0].x) * (double{p[1].y} - p[0].y));
}

struct PlacedImage {
  PixelImage image;
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
};

// The image on the coordinates `to`, with as many texels per area as it has itself, at most 4096 a side. Normals in
// tangent space are turned to the new directions of u and v. Texels on no triangle continue those beside them. Empty
// where triangles that show different things are at the same place of `to`: more than a hundredth of the texels would
// be off by 16 of 255. Linear in the texels of both.
[[nodiscard]] std::optional<PlacedImage> redraw(const PlacedImage& from, PixelMeaning meaning,
                                                std::span<const RedrawTriangle> triangles);

}  // namespace lodestone
