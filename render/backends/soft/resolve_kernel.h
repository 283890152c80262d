// Stage 4, a lane per pixel: colours of the visibility buffer. Attributes are first read here, of visible surfaces
// alone.
//
// A frame shades in *steps*, one for each effect that any of its models calls for, in the order of the effects. A step
// is skipped where no pixel of a group sees a model that calls for it.
#pragma once

#include <algorithm>
#include <array>

#include "core/base/prefetch.h"
#include "render/backends/soft/surface_kernel.h"
#include "render/effects/directional_light.h"
#include "render/effects/emission.h"
#include "render/effects/fog.h"
#include "render/effects/head_light.h"
#include "render/effects/level_tint.h"
#include "render/effects/normal_map.h"
#include "render/effects/occlusion_map.h"
#include "render/effects/shadow.h"
#include "render/effects/smooth_normals.h"
#include "render/effects/texture.h"
#include "render/effects/unlit.h"
#include "render/effects/vertex_colours.h"
#include "render/effects/wireframe.h"
#include "render/frame/renderer.h"
#include "render/frame/shading.h"

namespace lodestone::soft::LODESTONE_LANES {

// Changes the surface in the lanes of the mask.
using ShadingStep = void (*)(const ShadingJob& job, Surface& s, Int lanes);

// One normal for the whole triangle, for surfaces without smooth ones.
inline void face_normals(const ShadingJob&, Surface& s, Int) {
  s.normal = cross(difference(s.corner[1], s.corner[0]), difference(s.corner[2], s.corner[0]));
}

class ShadingPlan {
 public:
  explicit ShadingPlan(const Frame& frame) {
    const EffectSet called = frame.all_effects();
    const auto add = [&](Effect effect, ShadingStep step) {
      if (called.contains(effect)) steps_[count_++] = {effect, effect, step};
    };
    add(Effect::smooth_normals, smooth_normals);
    add(Effect::vertex_colours, vertex_colours);
    add(Effect::texture, texture);
    add(Effect::normal_map, normal_map);
    add(Effect::occlusion_map, occlusion_map);
    add(Effect::level_tint, level_tint);
    add(Effect::head_light, head_light);
    add(Effect::directional_light, directional_light);
    if (effects::has_shadow_pass(frame)) steps_[count_++] = {Effect::shadow, Effect::directional_light, shadow};
    add(Effect::unlit, unlit);
    lit_ = count_;
    add(Effect::emission, emission);
    add(Effect::wireframe, wireframe);
    add(Effect::fog, fog);
    flat_ = needs_face_normals(frame);
    corners_ = flat_ || called.contains_any({Effect::directional_light, Effect::wireframe});
    ambient_ = frame.settings.lighting.ambient;
  }

  // Colour of the surfaces, each channel in [0, 1].
  [[gnu::always_inline]] Points colour(const ResolveJob& job, Surface& s) const {
    s.colour = vectors_of_models(s, [](const ModelFrame& m) { return m.appearance.base_colour; });
    s.ambient = all(ambient_);
    s.light = all(0.0f);
    s.is_mapped = s.has_corners = false;
    if (corners_) find_corners(s);
    if (flat_) face_normals(job, s, s.seen);
    for (std::size_t k = 0; k < lit_; ++k) run(steps_[k], job, s);
    s.colour = scaled(s.ambient + (1 - ambient_) * min(s.light, all(1.0f)), s.colour);
    for (std::size_t k = lit_; k < count_; ++k) run(steps_[k], job, s);
    return s.colour;
  }

 private:
  struct Step {
    Effect effect{}, of_model{};  // the effect, and the one that models must call for to get it
    ShadingStep step = nullptr;
  };

  static void run(const Step& step, const ResolveJob& job, Surface& s) {
    const Int lanes = calling_for(s, step.of_model);
    const unsigned points = bits(lanes);
    if (points == 0) return;
    (*job.work)[static_cast<std::size_t>(step.effect)] += static_cast<unsigned>(std::popcount(points));
    step.step(job, s, lanes);
  }

  // Lanes whose model calls for an effect.
  static Int calling_for(const Surface& s, Effect effect) {
    if (s.model) return s.model->effects.contains(effect) ? s.seen : all(0);
    return s.seen & gathered([&](int k) { return s.cell[k]->model->effects.contains(effect) ? -1 : 0; });
  }

  // Some model is lit, and its normals are not all smooth.
  static bool needs_face_normals(const Frame& frame) {
    return std::ranges::any_of(frame.models, [](const ModelFrame& m) {
      const bool lit = m.effects.contains_any({Effect::head_light, Effect::directional_light});
      return lit && !(m.appearance.smooth && m.effects.contains(Effect::smooth_normals));
    });
  }

  std::array<Step, effect_count> steps_{};
  std::size_t count_ = 0, lit_ = 0;  // steps, and those before lights and albedo are brought together
  bool flat_ = false, corners_ = false;
  float ambient_ = 0;
};

inline Points uniform(Vec3f v) { return {all(v.x), all(v.y), all(v.z)}; }

inline Int to_bytes(const Points& colour) {
  const auto byte = [](Float v) { return truncated(v * 255.0f + 0.5f); };
  static_assert(std::endian::native == std::endian::little);
  return byte(colour.x) | byte(colour.y) << 8 | byte(colour.z) << 16 | static_cast<std::int32_t>(0xff00'0000u);
}

template <int Samples>
struct GroupResolver {
  const ResolveJob& job;
  const TileBuffer<Samples>& tile;
  const ShadingPlan& plan;
  Int background = to_bytes(uniform(job.frame->settings.background));

  // Colours as bytes of `width` pixels from (x, y) of the tile.
  Int operator()(int x, int y) const {
    const std::size_t at = static_cast<std::size_t>(y * tile_size + x);
    const Int px = (iota() + (job.rect.x0 + x)) * subpixels + subpixels / 2,
              py = all((job.rect.y0 + y) * subpixels + subpixels / 2);
    if constexpr (Samples == 1) {
      const Int seen = load<Float>(&tile.depth[at]) < 1.0f;
      if (bits(seen) == 0) return background;
      Surface s;
      find(at, 0, seen, px, py, s);
      return select(seen, to_bytes(plan.colour(job, s)), background);
    } else {
      return averaged(at, x, y);
    }
  }

  // Calls visit(first, same, surface, colour) for the triangles that `width` pixels from (x, y) see, each shaded once
  // in a pixel, at the centre where it covers all samples and at its first one elsewhere, so that nothing is read off
  // outside a triangle. `same[r]` has the pixels of `first` where sample r sees it, too.
  template <class Visit>
  [[gnu::always_inline]] void for_each_triangle(int x, int y, const Visit& visit) const {
    const std::size_t at = static_cast<std::size_t>(y * tile_size + x);
    const Int px = (iota() + (job.rect.x0 + x)) * subpixels + subpixels / 2,
              py = all((job.rect.y0 + y) * subpixels + subpixels / 2);
    Int number[Samples], seen[Samples], same[Samples];
    for (std::size_t s = 0; s < Samples; ++s) {
      seen[s] = load<Float>(&tile.depth[s * tile_pixels + at]) < 1.0f;
      if constexpr (Samples > 1) number[s] = numbers(at, s, bits(seen[s]));
    }
    for (std::size_t s = 0; s < Samples; ++s) {
      Int first = seen[s], count = all(0);
      for (std::size_t r = 0; r < Samples; ++r) {
        same[r] = seen[r];
        if constexpr (Samples > 1) same[r] &= number[r] == number[s];
        if (r < s) first &= ~same[r];
        count -= same[r];
      }
      const unsigned covered = bits(first);
      if (covered == 0) continue;
      const Int whole = count == Samples;
      SnappedPoint offset = sample_offsets<Samples>[s];
      Surface surface;
      find(at, s, first, px + (~whole & offset.x), py + (~whole & offset.y), surface);
      if constexpr (Samples > 1) move_to_centre(at, bits(whole) & covered, surface);
      visit(first, same, surface, plan.colour(job, surface));
    }
  }

 private:
  // Finds the surfaces of sample s at (px, py). At least one lane is seen; the others repeat it.
  [[gnu::always_inline]] void find(std::size_t at, std::size_t s, Int seen, Int px, Int py, Surface& surface) const {
    const std::uint32_t* references = &tile.reference[s * tile_pixels + at];
    const auto any = static_cast<std::int32_t>(references[std::countr_zero(bits(seen))]);
    surface.seen = seen;
    surface.depth = load<Float>(&tile.depth[s * tile_pixels + at]);
    find_surface(job, tile.sources, select(seen, load<Int>(references), all(any)), px, py, surface);
  }

  // Each sample counts for a quarter.
  Int averaged(std::size_t at, int x, int y) const {
    Int background_samples = all(0);
    for (std::size_t s = 0; s < Samples; ++s)
      background_samples -= ~(load<Float>(&tile.depth[s * tile_pixels + at]) < 1.0f);
    if (bits(background_samples == Samples) == all_lanes) return background;
    constexpr float part = 1.0f / Samples;
    const Vec3f& b = job.frame->settings.background;
    const Float empty = to_float(background_samples) * part;
    Points sum{empty * b.x, empty * b.y, empty * b.z};
    for_each_triangle(x, y, [&](Int first, const Int* same, const Surface&, const Points& colour) {
      Int count = all(0);
      for (std::size_t r = 0; r < Samples; ++r) count -= same[r];
      const Float weight = to_float(count) * part;
      const auto add = [&](Float& to, Float what) { to = select(first, to + weight * what, to); };
      add(sum.x, colour.x), add(sum.y, colour.y), add(sum.z, colour.z);
    });
    return to_bytes(sum);
  }

  // Triangles of the lanes of `covered`.
  Int numbers(std::size_t at, std::size_t s, unsigned covered) const {
    std::int32_t number[width]{};
    for (; covered != 0; covered &= covered - 1) {
      const int k = std::countr_zero(covered);
      number[k] = static_cast<std::int32_t>(
          tile.sources.triangle(tile.reference[s * tile_pixels + at + static_cast<std::size_t>(k)]));
    }
    return load<Int>(number);
  }

  // A fragment knows its place on the triangle at its own sample alone; the mean over a whole pixel is its centre.
  void move_to_centre(std::size_t at, unsigned whole, Surface& s) const {
    for (; whole != 0; whole &= whole - 1) {
      const int k = std::countr_zero(whole);
      const std::uint32_t* reference = &tile.reference[at + static_cast<std::size_t>(k)];
      if (Reference::is_record(*reference)) continue;
      float b = 0, c = 0;
      for (std::size_t r = 0; r < Samples; ++r) {
        const Fragment& fragment = tile.sources.fragment(reference[r * tile_pixels]);
        b += fragment.weight_b, c += fragment.weight_c;
      }
      b *= 1.0f / Samples, c *= 1.0f / Samples;
      s.weight[0][k] = (1 - b) - c, s.weight[1][k] = b, s.weight[2][k] = c;
    }
  }
};

// Attributes are scattered over memory; those of the next row are prefetched while one is shaded.
template <int Samples>
inline void prefetch_row(const ResolveJob& job, const TileBuffer<Samples>& tile, std::size_t y, std::size_t columns,
                         bool mapped) {
  for (std::size_t x = 0; x < columns; ++x) {
    const std::size_t at = y * tile_size + x;
    if (tile.depth[at] == 1 || Reference::is_record(tile.reference[at])) continue;
    const Fragment& fragment = tile.sources.fragment(tile.reference[at]);
    const DrawnCell& cell = job.drawn->cell_of(fragment.triangle);
    for (const std::uint32_t v : fragment.v) {
      prefetch(cell.normals + v);
      if (mapped && cell.uv) {
        prefetch(cell.positions + v);
        prefetch(cell.uv + v);
      }
      if (!cell.morphing) continue;
      prefetch(cell.parents.address(v));
      prefetch(cell.lambdas + v);
    }
  }
}

// Depth, `depth` in the order of the tile, and colours as bytes of `width` pixels from (x, y) of the tile by colours(x,
// y), into the picture.
template <int Samples, class Colours>
[[gnu::always_inline]] inline void resolve_rows(const ResolveJob& job, const TileBuffer<Samples>& tile,
                                                const float* depth, const Colours& colours) {
  const PixelRect& rect = job.rect;
  const int columns = rect.x1 - rect.x0, rows = rect.y1 - rect.y0;
  const bool mapped = job.frame->all_effects().contains_any(
      {Effect::texture, Effect::normal_map, Effect::occlusion_map, Effect::emission});
  for (int y = 0; y < rows; ++y) {
    if (y + 1 < rows)
      prefetch_row(job, tile, static_cast<std::size_t>(y + 1), static_cast<std::size_t>(columns), mapped);
    const std::size_t pixel = static_cast<std::size_t>(rect.y0 + y) * static_cast<std::size_t>(job.image->size.width) +
                              static_cast<std::size_t>(rect.x0);
    std::memcpy(&job.image->depth[pixel], depth + static_cast<std::size_t>(y) * tile_size,
                static_cast<std::size_t>(columns) * sizeof(float));
    for (int x = 0; x < columns; x += width) {
      std::int32_t bytes[width];
      store(bytes, colours(x, y));
      const int count = std::min(width, columns - x);
      std::memcpy(&job.image->rgba[4 * (pixel + static_cast<std::size_t>(x))], bytes,
                  static_cast<std::size_t>(count) * 4);
    }
  }
}

template <int Samples>
void resolve(const ResolveJob& job, const TileBuffer<Samples>& tile) {
  const ShadingPlan plan(*job.frame);
  resolve_rows(job, tile, tile.depth.data(), GroupResolver<Samples>{job, tile, plan});
}

}  // namespace lodestone::soft::LODESTONE_LANES
