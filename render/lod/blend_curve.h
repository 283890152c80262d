// Curves of a user's own: their texts, checks and values, the same for every backend.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "render/lod/blend.h"

namespace lodestone {

// "table:0,0.1,0.9,1", "polynomial:0,0,3,-2", in the fewest digits that give the same curve.
[[nodiscard]] std::string text_of(const BlendCurve& curve);
// True for a text that starts as such a one.
[[nodiscard]] bool is_curve_text(std::string_view text);
// Throw InputError for another text, for a number that is none, and for a curve that does not go from 0 to 1 (exactly
// at 0, within 1e-6 at 1), that decreases somewhere, or that has another number of values.
[[nodiscard]] BlendCurve blend_curve(std::string_view text);
void check_curve(const BlendCurve& curve);

// At least the Lipschitz constant of s, and at most a thousandth more. For a curve that check_curve accepts.
[[nodiscard]] double curve_lipschitz(const BlendCurve& curve);

// s(t) in single precision, by the same operations here and in the shaders. A polynomial is evaluated from the nearer
// end: near 1 it would lose its monotony to cancellation.
class CurveShare {
 public:
  explicit CurveShare(const BlendCurve& curve);  // that check_curve accepts
  [[nodiscard]] float operator()(float t) const;
  // In GLSL: "float share(float t) {...}", for t between 0 and 1.
  [[nodiscard]] std::string glsl() const;

 private:
  BlendCurve curve_;
  std::vector<float> from_end_;  // coefficients of 1 - s(1 - u)
};

}  // namespace lodestone
