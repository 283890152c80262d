// The input of shading: the frame and the cells that it draws.
#pragma once

#include <cstdint>

#include "core/hierarchy/model/hierarchy.h"
#include "render/camera/projection.h"
#include "render/frame/frame.h"

namespace lodestone {
class SurfaceTextures;
}

namespace lodestone::soft {

// Window coordinates are snapped to 1/256 pixel.
inline constexpr int subpixel_bits = 8;
inline constexpr int subpixels = 1 << subpixel_bits;

// A triangle of the frame: a number of its own, increasing in drawing order. Numbers of a cell are consecutive and
// start at a multiple of 256, so that number / 256 finds the cell.
using TriangleNumber = std::uint32_t;
inline constexpr int numbers_per_block_bits = 8;

// A visible cell in a frame.
struct DrawnCell {
  CellId cell;
  std::uint8_t level = 0;
  bool morphing = false;  // false: lambda = 1 on the whole of it, neither lambdas nor parents are looked at
  TriangleNumber first_triangle = 0;
  const ModelFrame* model = nullptr;
  const Cell *own = nullptr, *coarser = nullptr;  // the cell; and its parent, where it morphs
  // Arrays of the vertices of the cell, and of its parent if it morphs; texture coordinates if the model has them.
  const Vec3f *positions = nullptr, *coarser_positions = nullptr;
  const Vec2f *uv = nullptr, *coarser_uv = nullptr;
  // Normals likewise, and the vertices' parents.
  const PackedNormal* normals = nullptr;
  const PackedNormal* coarser_normals = nullptr;
  Indices parents;
  float* lambdas = nullptr;  // of the vertices where it morphs, as the vertex stage has left them
};

// The map of the directional light, rows from the top; depth is null where there is none. `first` is the depth of the
// first caster that is not opaque, `through` the share of the light that all of these let through; null where there are
// none.
struct ShadowView {
  const float* depth = nullptr;
  int texels = 0;  // a side
  const float *first = nullptr, *through = nullptr;
};

// The parts of a frame that the stages of shading read.
struct ShadingJob {
  const Frame* frame = nullptr;
  float half_width = 0, half_height = 0;      // half the picture, in subpixels
  const Eye* eyes = nullptr;                  // of the models of the frame
  const SurfaceTextures* textures = nullptr;  // of the models
  ShadowView shadow{};
};

}  // namespace lodestone::soft
