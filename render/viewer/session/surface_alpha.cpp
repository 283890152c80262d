// Textures are looked up as in render/effects/texture_mapping.h, one point at a time.
#include "render/viewer/session/surface_alpha.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/hierarchy/model/material_of.h"
#include "render/effects/transparency.h"

namespace lodestone::viewer {
namespace {

double mixed(double lambda, double own, double parent) { return lambda * own + (1 - lambda) * parent; }

// value(cell, vertex) at the corners of the triangle, morphed with them.
template <class Value>
std::array<double, 3> morphed_values(const ModelFrame& model, const MetTriangle& met, const Value& value) {
  const Hierarchy& hierarchy = *model.morph.hierarchy;
  const Cell& cell = hierarchy.cells[met.cell];
  std::array<double, 3> values{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = met.corners[k];
    values[k] = value(cell, v);
    if (!met.morphing) continue;
    const double lambda = vertex_lambda(model.morph, met.cell, VertexId(v));
    values[k] = mixed(lambda, values[k], value(hierarchy.cells[cell.parent], cell.parents[v]));
  }
  return values;
}

double interpolated(const std::array<double, 3>& corners, CornerShares at) {
  return (1 - at.b - at.c) * corners[0] + at.b * corners[1] + at.c * corners[2];
}

double wrapped(double t, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return std::clamp(t, 0.0, 1.0);
  if (wrap == TextureWrap::repeat) return t - std::floor(t);
  t -= 2 * std::floor(0.5 * t);
  return t > 1 ? 2 - t : t;
}

// Alpha of a level at (u, v) in [0, 1], from 0 to 1.
double bilinear_alpha(const MipLevel& level, double u, double v) {
  const double x = u * level.size.width + 0.5, y = v * level.size.height + 0.5;
  const auto column = static_cast<std::uint32_t>(x), row = static_cast<std::uint32_t>(y);
  const auto alpha = [&](std::uint32_t i, std::uint32_t j) {
    return level.texels[std::size_t{row + j} * level.stride() + column + i] >> 24;
  };
  const double along = x - column, down = y - row;
  return mixed(1 - down, mixed(1 - along, alpha(0, 0), alpha(1, 0)), mixed(1 - along, alpha(0, 1), alpha(1, 1))) / 255;
}

}  // namespace

void SurfaceAlpha::prepare(const Frame& frame, Scheduler& scheduler) {
  Frame alone = frame;  // no effect but transparency asks for a texture
  for (ModelFrame& model : alone.models) model.effects = {};
  (void)textures_.prepare(alone, scheduler);
}

float SurfaceAlpha::opacity(const Frame& frame, const ModelFrame& model, const MetTriangle& met) const {
  const float of_model = effects::is_transparent(frame, model) ? model.appearance.opacity : 1;
  if (!shows_alpha(frame, model)) return of_model;
  const Hierarchy& hierarchy = *model.morph.hierarchy;
  const std::uint32_t number = material_of(hierarchy, hierarchy.cells[met.cell], met.corners[0]);
  const SurfaceMaterial& material = textures_.materials(model.model)[number + std::uint32_t{1}];
  if (material.alpha_mode == AlphaMode::opaque) return of_model;
  double alpha = double{material.alpha};
  if (model.appearance.vertex_colours && hierarchy.attributes.colours)
    alpha *= interpolated(
        morphed_values(model, met,
                       [](const Cell& cell, std::uint32_t v) { return cell.attributes.colours[v].a / 255.0; }),
        met.here);
  if (material.texture != no_texture) alpha *= alpha_of_texture(model, textures_.textures()[material.texture], met);
  if (material.alpha_mode == AlphaMode::mask) alpha = alpha < double{material.alpha_cutoff} ? 0 : 1;
  return of_model * static_cast<float>(std::clamp(alpha, 0.0, 1.0));
}

double SurfaceAlpha::alpha_of_texture(const ModelFrame& model, const SurfaceTexture& texture,
                                      const MetTriangle& met) const {
  const auto u_of = [](const Cell& cell, std::uint32_t vertex) { return double{cell.attributes.uv[vertex].x}; };
  const auto v_of = [](const Cell& cell, std::uint32_t vertex) { return double{cell.attributes.uv[vertex].y}; };
  const auto u = morphed_values(model, met, u_of), v = morphed_values(model, met, v_of);
  const double at_u = interpolated(u, met.here), at_v = interpolated(v, met.here);
  const PixelSize size = texture.levels.front().size;
  const auto texels2_to = [&](CornerShares beside) {
    const double across = (interpolated(u, beside) - at_u) * size.width,
                 down = (interpolated(v, beside) - at_v) * size.height;
    return across * across + down * down;
  };
  const auto extent2 = static_cast<float>(std::max({texels2_to(met.right), texels2_to(met.below), 1.0}));
  const double lod = std::min((std::bit_cast<std::int32_t>(extent2) - 0x3f80'0000) * (0.5 / 8388608),
                              static_cast<double>(texture.levels.size() - 1));
  const double x = wrapped(at_u, texture.wrap_u), y = wrapped(at_v, texture.wrap_v);
  if (!std::isfinite(extent2) || !std::isfinite(x) || !std::isfinite(y)) return 1;
  const auto finer = static_cast<std::size_t>(lod);
  const double share = lod - static_cast<double>(finer);
  const double near = bilinear_alpha(texture.levels[finer], x, y);
  return share > 0 ? mixed(1 - share, near, bilinear_alpha(texture.levels[finer + 1], x, y)) : near;
}

}  // namespace lodestone::viewer
