// Blending functions b: how a vertex travels from its own position to its parent's as the viewpoint moves away.
//
// Each is given on the unit interval by its share of the way, s(t): s(0) = 0, s(1) = 1, non-decreasing; lambda = 1 - s.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace lodestone {

enum class Blend : std::uint8_t {
  linear,
  smoothstep,    // 3t^2 - 2t^3
  smootherstep,  // 6t^5 - 15t^4 + 10t^3 (Perlin 2002)
  cosine,        // (1 - cos pi t) / 2
  early,         // smoothstep over the first half of the band: the parent's place is reached half-way
  late,          // smoothstep over the second half
  step,          // jumps at the middle: the popping baseline, continuous nowhere it matters
  // Further values are curves of a user's own.
};

// A blending function as data: s(t) on [0, 1]; t is clamped, and so is s.
struct BlendCurve {
  enum class Kind : std::uint8_t {
    table,       // values at equal distances, the first at 0 and the last at 1, straight lines between: 2 to 65
    polynomial,  // coefficients of 1, t, t^2, ...: 2 to 8
  };
  Kind kind = Kind::table;
  std::vector<float> values;

  friend bool operator==(const BlendCurve&, const BlendCurve&) = default;
};

// A curve of one's own; equal ones are one blend. Throws InputError for a curve that is none (blend_curve.h),
// ResourceError for more than 240 in a process. May be called from any thread.
[[nodiscard]] Blend own_blend(const BlendCurve& curve);
// The curve of such a blend; null for those with a name.
[[nodiscard]] const BlendCurve* curve_of(Blend blend);

// The blend of this name, or of the curve of this text. Throws InputError listing the known names.
[[nodiscard]] Blend blend_named(std::string_view name);
[[nodiscard]] std::string_view name_of(Blend blend);  // or the text of its curve
[[nodiscard]] std::span<const Blend> all_blends();    // with a name

// s(t); t is clamped to [0, 1]. Exactly 0 at t <= 0 and exactly 1 at t >= 1.
[[nodiscard]] float blend_share(Blend blend, float t);

// Lipschitz constant of s on [0, 1], which bounds pops; for `step` that of `linear`, which is what its jumps are
// measured against.
[[nodiscard]] double blend_lipschitz(Blend blend);

}  // namespace lodestone
