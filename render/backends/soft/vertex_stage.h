// Stage 1: vertices of the visible cells, morphed, transformed and snapped.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "render/backends/soft/raster_types.h"
#include "render/renderer.h"

namespace lodestone::soft {

// Before the division by w.
struct ClipVertex {
  float x = 0, y = 0, z = 0, w = 1;
  Vec3f normal;
};

// From clip space to snapped window coordinates, for one picture size.
class Viewport {
 public:
  explicit Viewport(ImageSize size);
  [[nodiscard]] std::uint32_t outcode(const ClipVertex& v) const;
  // Only for vertices without needs_clipping; the outcode is left to the caller.
  [[nodiscard]] WindowVertex snap(const ClipVertex& v) const;
  // |x| <= guard_x() w and |y| <= guard_y() w is the guard band.
  [[nodiscard]] float guard_x() const { return guard_x_; }
  [[nodiscard]] float guard_y() const { return guard_y_; }

 private:
  float half_width_, half_height_;  // subpixels
  float guard_x_, guard_y_;
};

[[nodiscard]] ClipVertex to_clip(const ViewProjection& vp, Vec3f position, Vec3f normal);

// Working memory of one worker.
using MorphScratch = std::vector<MorphedVertex>;

// All vertices of a cell. out.size() == positions of the cell. A cell whose `morphing` is false skips the morph: lambda
// is 1 on the whole of it, so the result is the same.
void transform_cell(const Frame& frame, const Viewport& viewport, const SelectedCell& selected, MorphScratch& scratch,
                    std::span<WindowVertex> out);

// One vertex again, before the division, for the few triangles that are clipped.
[[nodiscard]] ClipVertex clip_vertex(const Frame& frame, const SelectedCell& selected, std::uint32_t vertex);

}  // namespace lodestone::soft
