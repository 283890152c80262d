// Transparent surfaces, in lanes: which samples of a tile they cover, and what light they add.
#pragma once

#include "render/backends/soft/raster_kernel.h"
#include "render/backends/soft/resolve_kernel.h"
#include "render/effects/material_alpha.h"

namespace lodestone::soft::LODESTONE_LANES {

// Keeps all samples in front of the opaque surfaces.
template <int Samples>
class LayerTarget {
 public:
  LayerTarget(const TriangleRecord& t, std::uint32_t reference, const TileBuffer<Samples>& opaque, LayerList& found)
      : triangle_(t.triangle),
        reference_(reference),
        nearest_(std::min({t.z[0], t.z[1], t.z[2]})),
        opaque_(opaque),
        found_(found) {}

  [[nodiscard]] bool skips(int x, int y) const {
    constexpr int size = TileBuffer<Samples>::block_size, columns = TileBuffer<Samples>::blocks_per_row;
    return nearest_ - 4e-7f > opaque_.farthest[static_cast<std::size_t>((y / size) * columns + x / size)];
  }
  static void changed(int, int) {}

  template <class TriangleInThisTile>
  bool cover(const TriangleInThisTile& t, int x, int y, std::size_t s, Int inside, Int ab, Int ca) {
    const Float z = t.depths(x, y, s, ab, ca);
    const std::size_t at = s * tile_pixels + static_cast<std::size_t>(y * tile_size + x);
    for (unsigned kept = bits(inside & (z < load<Float>(&opaque_.depth[at]))); kept != 0; kept &= kept - 1) {
      const int k = std::countr_zero(kept);
      found_.push({static_cast<std::uint32_t>(at) + static_cast<std::uint32_t>(k), z[k], triangle_, reference_});
    }
    return false;
  }

 private:
  TriangleNumber triangle_;
  std::uint32_t reference_;
  float nearest_;
  const TileBuffer<Samples>& opaque_;
  LayerList& found_;
};

template <int Samples>
void collect_layers(const TriangleRecord* first, const TriangleRecord* last, PixelRect rect,
                    const TileBuffer<Samples>& opaque, std::uint32_t reference, LayerList& found) {
  for (const TriangleRecord* t = first; t != last; ++t, ++reference) {
    LayerTarget<Samples> target(*t, reference, opaque, found);
    draw_record<Samples>(*t, rect, target);
  }
}

// A layer is put behind those before it: the light that it adds is the share that these let through.
template <int Samples>
void shade_layer(const ResolveJob& job, const TileBuffer<Samples>& layer, const LayerLight& light) {
  const ShadingPlan plan(*job.frame);
  const GroupResolver<Samples> group{job, layer, plan};
  const int columns = job.rect.x1 - job.rect.x0, rows = job.rect.y1 - job.rect.y0;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; x += width) {
      const std::size_t at = static_cast<std::size_t>(y * tile_size + x);
      group.for_each_triangle(x, y, [&](Int first, const Int* same, Surface& s, const Points& colour) {
        (*job.work)[static_cast<std::size_t>(Effect::transparency)] +=
            static_cast<unsigned>(std::popcount(bits(first)));
        const auto [opacity, solid] = opacities(job, s);
        for (std::size_t r = 0; r < Samples; ++r) {
          const std::size_t place = r * tile_pixels + at;
          const Int here = first & same[r];
          if (bits(here) == 0) continue;
          const Float through = load<Float>(light.through + place), share = through * opacity;
          const auto add = [&](float* to, Float what) {
            const Float old = load<Float>(to + place);
            store(to + place, select(here, old + share * what, old));
          };
          add(light.red, colour.x), add(light.green, colour.y), add(light.blue, colour.z);
          store(light.through + place, select(here, through * (1.0f - opacity), through));
          const auto set = [&](float* to, Int lanes, const float* from) {
            store(to + place, select(lanes, load<Float>(from + place), load<Float>(to + place)));
          };
          set(light.seen, here & ~solid, light.through);
          set(light.depth, here & solid, layer.depth.data());
          const Float own = load<Float>(layer.depth.data() + place), before = load<Float>(light.first + place);
          store(light.first + place, select(here & ~solid & (opacity > 0.0f) & (own < before), own, before));
        }
      });
    }
}

// Adds the opaque surfaces and the background, seen through the layers, to the layers.
template <int Samples>
void resolve_layered(const ResolveJob& job, const TileBuffer<Samples>& tile) {
  const LayerLight& layers = *job.layers;
  const ShadingPlan plan(*job.frame);
  const GroupResolver<Samples> group{job, tile, plan};
  constexpr float part = 1.0f / Samples;
  const Vec3f background = job.frame->settings.background;
  resolve_rows(job, tile, layers.depth, [&](int x, int y) {
    const std::size_t at = static_cast<std::size_t>(y * tile_size + x);
    Points sum{all(0.0f), all(0.0f), all(0.0f)};
    Float background_through = all(0.0f), all_seen = all(0.0f);
    for (std::size_t r = 0; r < Samples; ++r) {
      const std::size_t place = r * tile_pixels + at;
      const Float through = load<Float>(layers.through + place);
      const Int empty = ~(load<Float>(&tile.depth[place]) < 1.0f);
      background_through += as_float(empty & as_int(part * through));
      all_seen += part * load<Float>(layers.seen + place);
      sum.x += part * load<Float>(layers.red + place);
      sum.y += part * load<Float>(layers.green + place);
      sum.z += part * load<Float>(layers.blue + place);
    }
    sum.x += background_through * background.x;
    sum.y += background_through * background.y;
    sum.z += background_through * background.z;
    group.for_each_triangle(x, y, [&](Int first, const Int* same, const Surface&, const Points& colour) {
      Float share = all(0.0f);
      for (std::size_t r = 0; r < Samples; ++r)
        share += as_float(first & same[r] & as_int(part * load<Float>(layers.through + r * tile_pixels + at)));
      sum.x += as_float(first & as_int(share * colour.x));
      sum.y += as_float(first & as_int(share * colour.y));
      sum.z += as_float(first & as_int(share * colour.z));
    });
    const Int alpha = job.keeps_through ? truncated(min(all_seen, all(1.0f)) * 255.0f + 0.5f) : all(255);
    const auto most_one = [](const Points& p) {
      return Points{min(p.x, all(1.0f)), min(p.y, all(1.0f)), min(p.z, all(1.0f))};
    };
    return (to_bytes(most_one(sum)) & 0x00ff'ffff) | alpha << 24;
  });
}

}  // namespace lodestone::soft::LODESTONE_LANES
