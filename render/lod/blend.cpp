#include "render/lod/blend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/error.h"
#include "core/base/known_names.h"

namespace lodestone {
namespace {

constexpr std::array<Blend, 7> blends{Blend::linear, Blend::smoothstep, Blend::smootherstep, Blend::cosine,
                                      Blend::early,  Blend::late,       Blend::step};
constexpr std::array<std::string_view, 7> names{"linear", "smoothstep", "smootherstep", "cosine",
                                                "early",  "late",       "step"};

float smoothstep(float t) { return t * t * (3 - 2 * t); }

// Symmetric about the middle; towards 1 the polynomial itself would lose its monotony to cancellation.
float smootherstep(float t) {
  const auto lower = [](float u) { return u * u * u * (u * (u * 6 - 15) + 10); };
  return t <= 0.5f ? lower(t) : 1 - lower(1 - t);
}

}  // namespace

std::span<const Blend> all_blends() { return blends; }

std::string_view name_of(Blend blend) { return names[static_cast<std::size_t>(blend)]; }

Blend blend(std::string_view name) {
  for (const Blend candidate : blends)
    if (name == name_of(candidate)) return candidate;
  throw InputError("unknown blending function '" + std::string(name) + "'; " +
                   known_names(name, {names.begin(), names.end()}));
}

float blend_share(Blend blend, float t) {
  if (!(t > 0)) return 0;
  if (t >= 1) return 1;
  const auto share = [&] {
    switch (blend) {
      case Blend::linear:
        return t;
      case Blend::smoothstep:
        return smoothstep(t);
      case Blend::smootherstep:
        return smootherstep(t);
      case Blend::cosine:
        return (1 - std::cos(std::numbers::pi_v<float> * t)) / 2;
      case Blend::early:
        return smoothstep(std::min(2 * t, 1.0f));
      case Blend::late:
        return smoothstep(std::max(2 * t - 1, 0.0f));
      case Blend::step:
        return t < 0.5f ? 0.0f : 1.0f;
    }
    return t;
  }();
  return std::clamp(share, 0.0f, 1.0f);
}

double blend_lipschitz(Blend blend) {
  switch (blend) {
    case Blend::linear:
    case Blend::step:
      return 1;
    case Blend::smoothstep:
      return 1.5;
    case Blend::smootherstep:
      return 1.875;
    case Blend::cosine:
      return std::numbers::pi / 2;
    case Blend::early:
    case Blend::late:
      return 3;
  }
  return 1;
}

}  // namespace lodestone
