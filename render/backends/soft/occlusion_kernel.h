// Ambient occlusion, a lane per pixel (render/effects/ambient_occlusion.h).
#pragma once

#include <algorithm>

#include "render/backends/soft/kernels.h"
#include "render/effects/ambient_occlusion.h"
#include "render/surface/lanes.h"

namespace lodestone::soft::LODESTONE_LANES {

class Occlusion {
 public:
  Occlusion(const effects::OcclusionJob& job, const Image& image)
      : job_(job), depth_(image.depth.data()), size_(image.size), pattern_(effects::occlusion_pattern()) {}

  // Factors of the pixels from (x, y) on, in the lanes of `seen`, which have these depths.
  [[nodiscard]] Float factors(Int x, Int y, Float depth, Float through) const {
    const Float w = distance(depth);
    const Points here = place(x, y, w);
    const float pixels = 0.5f * static_cast<float>(size_.height) / job_.tan_y;  // at w = 1, for a length of 1
    const Float reach = min(job_.radius * pixels / w, all(effects::occlusion_reach * static_cast<float>(size_.height)));
    const Int large = reach >= 1.0f;
    if (bits(large) == 0) return all(1.0f);
    const Float per_radius = pixels / (reach * w);  // 1 over the radius
    const Points n = normal(x, y, here);
    Float sum = all(0.0f);
    for (const auto& [px, py] : pattern_) {
      const Int qx = x + rounded(px * reach), qy = y + rounded(py * reach);
      const Int inside = (qx >= 0) & (qx < size_.width) & (qy >= 0) & (qy < size_.height);
      const Points there = place_at(select(inside, qx, x), select(inside, qy, y));
      const Points t{per_radius * (there.x - here.x), per_radius * (there.y - here.y), per_radius * (there.z - here.z)};
      const Float tt = (t.x * t.x + t.y * t.y) + t.z * t.z, tn = (t.x * n.x + t.y * n.y) + t.z * n.z;
      const Float near = max(1.0f - tt, all(0.0f));
      const Float part =
          near * near * near * max((tn - effects::occlusion_bias) / (tt + effects::occlusion_epsilon), all(0.0f));
      sum += as_float(inside & as_int(part));
    }
    const Float occluded = min(sum * (5.0f / effects::occlusion_points), all(1.0f));
    return select(large, 1.0f - job_.strength * clear(here) * through * occluded, all(1.0f));
  }

 private:
  // Along the view axis.
  [[nodiscard]] Float distance(Float depth) const {
    return job_.near * job_.far / (job_.far - depth * (job_.far - job_.near));
  }
  // Positions in the space of the eye: right, down, forward.
  [[nodiscard]] Points place(Int x, Int y, Float w) const {
    const auto along = [](Int i, int count, float tan) {
      return ((to_float(i) + 0.5f) * (2.0f / static_cast<float>(count)) - 1.0f) * tan;
    };
    return {along(x, size_.width, job_.tan_x) * w, along(y, size_.height, job_.tan_y) * w, w};
  }
  [[nodiscard]] Points place_at(Int x, Int y) const {
    const Int at = y * size_.width + x;
    return place(x, y, distance(as_float(gathered([&](int k) {
                   return std::bit_cast<std::int32_t>(depth_[static_cast<std::size_t>(at[k])]);
                 }))));
  }
  // From the neighbours that are less far away in depth, towards the eye.
  [[nodiscard]] Points normal(Int x, Int y, const Points& here) const {
    const auto step = [&](Int dx, Int dy) {
      const Int limit_x = all(size_.width - 1), limit_y = all(size_.height - 1);
      const Points before = place_at(max(x - dx, all(0)), max(y - dy, all(0)));
      const Points after = place_at(min(x + dx, limit_x), min(y + dy, limit_y));
      const Int at_begin = (x - dx < 0) | (y - dy < 0), at_end = (x + dx > limit_x) | (y + dy > limit_y);
      const Int forward = ~at_end & (at_begin | (abs(after.z - here.z) <= abs(here.z - before.z)));
      return Points{select(forward, after.x - here.x, here.x - before.x),
                    select(forward, after.y - here.y, here.y - before.y),
                    select(forward, after.z - here.z, here.z - before.z)};
    };
    const Points a = step(all(1), all(0)), b = step(all(0), all(1));
    const Points n{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    const Float size = sqrt((n.x * n.x + n.y * n.y) + n.z * n.z);
    const Float away = (n.x * here.x + n.y * here.y) + n.z * here.z;
    const Float scale = select(away > 0.0f, all(-1.0f), all(1.0f)) / max(size, all(1e-30f));
    return {scale * n.x, scale * n.y, scale * n.z};
  }
  // The share that fog lets through.
  [[nodiscard]] Float clear(const Points& here) const {
    if (!(job_.fog_density > 0)) return all(1.0f);
    const Float apart = sqrt((here.x * here.x + here.y * here.y) + here.z * here.z);
    Float share;
    for (int k = 0; k < width; ++k) share[k] = std::exp(-job_.fog_density * apart[k]);
    return share;
  }

  effects::OcclusionJob job_;
  const float* depth_;
  ImageSize size_;
  std::array<std::array<float, 2>, effects::occlusion_points> pattern_;
};

// The rows [first, last) of the picture; alpha is the share that the layers let through, and 255 afterwards.
inline void occlude(const effects::OcclusionJob& job, int first, int last, Image& image) {
  const Occlusion occlusion(job, image);
  const auto [columns, rows] = image.size;
  for (int y = first; y < last; ++y)
    for (int x = 0; x < columns; x += width) {
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x);
      const auto count = static_cast<std::size_t>(std::min(width, columns - x));
      float depth[width];
      std::int32_t pixels[width]{};
      std::fill_n(depth, width, 1.0f);
      std::copy_n(&image.depth[at], count, depth);
      std::memcpy(pixels, &image.rgba[4 * at], 4 * count);
      const Float d = load<Float>(depth);
      const Int seen = d < 1.0f, colour = load<Int>(pixels);
      const auto channel = [&](int shift) { return to_float((colour >> shift) & 255); };
      Float factor = all(1.0f);
      if (bits(seen)) {
        const Int column = min(iota() + x, all(columns - 1));
        factor = select(seen, occlusion.factors(column, all(y), d, channel(24) / 255.0f), factor);
      }
      const auto darkened = [&](int shift) { return truncated(channel(shift) * factor + 0.5f) << shift; };
      store(pixels, darkened(0) | darkened(8) | darkened(16) | static_cast<std::int32_t>(0xff00'0000u));
      std::memcpy(&image.rgba[4 * at], pixels, 4 * count);
    }
}

}  // namespace lodestone::soft::LODESTONE_LANES
