#include "render/lod/morph.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace lodestone {

float morph_lambda(const MorphContext& context, int level, Vec3f w) {
  const auto l = static_cast<std::size_t>(level);
  const float begin = context.radii->band_begin[l], end = context.radii->band_end[l];
  const float d = distance(context.radii->metric, context.viewpoint, w);
  // At the root begin is infinite. An inadmissible band is empty, and begin == end is the place of its step.
  if (d < begin || (d <= begin && begin < end)) return 1;
  if (d >= end) return 0;
  return 1 - blend_share(context.blend, (d - begin) / (end - begin));
}

Vec3f morph_position(const MorphContext& context, int level, Vec3f w, Vec3f parent_position) {
  const float lambda = morph_lambda(context, level, w);
  if (lambda >= 1) return w;
  if (lambda <= 0) return parent_position;
  return lambda * w + (1 - lambda) * parent_position;
}

void morph_cell(const MorphContext& context, std::uint32_t cell, std::span<Vec3f> out) {
  const Cell& c = context.hierarchy->cells[cell];
  assert(out.size() == c.positions.size());
  const int level = context.hierarchy->level_of(cell);
  if (level == 0) {
    std::copy(c.positions.begin(), c.positions.end(), out.begin());
    return;
  }
  const std::span<const Vec3f> coarser = context.hierarchy->cells[c.parent].positions;
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = morph_position(context, level, c.positions[i], coarser[c.parents[i]]);
}

void morph_cell_normals(const MorphContext& context, std::uint32_t cell, std::span<Vec3f> out) {
  const Cell& c = context.hierarchy->cells[cell];
  assert(out.size() == c.normals.size());
  const int level = context.hierarchy->level_of(cell);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Vec3f own = unpack_normal(c.normals[i]);
    const float lambda = level == 0 ? 1 : morph_lambda(context, level, c.positions[i]);
    if (lambda >= 1) {
      out[i] = own;
      continue;
    }
    const Vec3f coarser = unpack_normal(context.hierarchy->cells[c.parent].normals[c.parents[i]]);
    const Vec3f sum = lambda <= 0 ? coarser : lambda * own + (1 - lambda) * coarser;
    const float norm2 = dot(sum, sum);
    out[i] = norm2 > 1e-12f ? (1 / std::sqrt(norm2)) * sum : coarser;
  }
}

}  // namespace lodestone
