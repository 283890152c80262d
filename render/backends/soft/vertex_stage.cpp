#include "render/backends/soft/vertex_stage.h"

#include <cmath>

namespace lodestone::soft {
namespace {

// Round half up, for any |v| below 2^22; exact, since the sum is formed in double.
std::int32_t round_to_int(float v) {
  constexpr int offset = 1 << 23;
  return static_cast<std::int32_t>(double{v} + (offset + 0.5)) - offset;
}

}  // namespace

Viewport::Viewport(ImageSize size)
    : half_width_(static_cast<float>(size.width) * (subpixels / 2)),
      half_height_(static_cast<float>(size.height) * (subpixels / 2)),
      guard_x_(1 + 2 * guard_pixels / static_cast<float>(size.width)),
      guard_y_(1 + 2 * guard_pixels / static_cast<float>(size.height)) {}

std::uint32_t Viewport::outcode(const ClipVertex& v) const {
  std::uint32_t code = (v.x < -v.w ? 1u : 0) | (v.x > v.w ? 2u : 0) | (v.y < -v.w ? 4u : 0) | (v.y > v.w ? 8u : 0) |
                       (v.z < -v.w ? 16u : 0) | (v.z > v.w ? 32u : 0);
  const bool inside =
      v.z >= -v.w && v.z <= v.w && std::abs(v.x) <= guard_x_ * v.w && std::abs(v.y) <= guard_y_ * v.w && v.w > 0;
  return inside ? code : code | needs_clipping;
}

WindowVertex Viewport::snap(const ClipVertex& v) const {
  WindowVertex out;
  out.inverse_w = 1 / v.w;
  out.x = round_to_int((1 + v.x * out.inverse_w) * half_width_);
  out.y = round_to_int((1 - v.y * out.inverse_w) * half_height_);
  out.z = 0.5f + 0.5f * (v.z * out.inverse_w);
  out.normal = v.normal;
  return out;
}

ClipVertex to_clip(const ViewProjection& vp, Vec3f p, Vec3f normal) {
  const auto& m = vp.m;
  return {((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3], ((m[4] * p.x + m[5] * p.y) + m[6] * p.z) + m[7],
          ((m[8] * p.x + m[9] * p.y) + m[10] * p.z) + m[11], ((m[12] * p.x + m[13] * p.y) + m[14] * p.z) + m[15],
          normal};
}

void transform_cell(const Frame& frame, const Viewport& viewport, const SelectedCell& selected, MorphScratch& scratch,
                    std::span<WindowVertex> out) {
  const Cell& cell = frame.morph.hierarchy->cells[selected.cell];
  const auto emit = [&](std::size_t i, Vec3f position, Vec3f normal) {
    const ClipVertex v = to_clip(frame.view_projection, position, normal);
    const std::uint32_t code = viewport.outcode(v);
    if ((code & needs_clipping) == 0) out[i] = viewport.snap(v);
    out[i].outcode = code;
  };
  if (!selected.morphing) {
    for (std::size_t i = 0; i < out.size(); ++i) emit(i, cell.positions[i], unpack_normal(cell.normals[i]));
    return;
  }
  scratch.resize(out.size());
  morph_cell_vertices(frame.morph, selected.cell, scratch);
  for (std::size_t i = 0; i < out.size(); ++i) emit(i, scratch[i].position, scratch[i].normal);
}

ClipVertex clip_vertex(const Frame& frame, const SelectedCell& selected, std::uint32_t vertex) {
  const MorphedVertex v = morph_vertex(frame.morph, selected.cell, vertex);
  return to_clip(frame.view_projection, v.position, v.normal);
}

}  // namespace lodestone::soft
