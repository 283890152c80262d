#include "render/lod/blend.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
#include <string>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "render/lod/blend_curve.h"

namespace lodestone {
namespace {

constexpr std::array<Blend, 7> blends{Blend::linear, Blend::smoothstep, Blend::smootherstep, Blend::cosine,
                                      Blend::early,  Blend::late,       Blend::step};
constexpr std::array<std::string_view, 7> names{"linear", "smoothstep", "smootherstep", "cosine",
                                                "early",  "late",       "step"};

// Curves keep their place. A blend is looked up for every vertex, so readers take no lock.
class OwnBlends {
 public:
  Blend add(const BlendCurve& curve) {
    check_curve(curve);
    const std::scoped_lock lock(mutex_);
    std::size_t at = 0;
    const std::size_t count = count_;
    while (at < count && entries_[at]->curve != curve) ++at;
    if (at == entries_.size())
      throw ResourceError("a process knows up to " + std::to_string(entries_.size()) +
                          " blending functions of a user's");
    if (at == count) {
      entries_[at] = std::make_unique<Entry>(Entry{curve, text_of(curve), curve_lipschitz(curve), CurveShare(curve)});
      count_ = count + 1;
    }
    return static_cast<Blend>(names.size() + at);
  }

  struct Entry {
    BlendCurve curve;
    std::string text;
    double lipschitz;
    CurveShare share;
  };
  // Null for a blend that has a name.
  [[nodiscard]] const Entry* find(Blend blend) const {
    const auto number = static_cast<std::size_t>(blend);
    return number < names.size() ? nullptr : entries_[number - names.size()].get();
  }

 private:
  std::mutex mutex_;
  std::atomic<std::size_t> count_{0};
  std::array<std::unique_ptr<const Entry>, 240> entries_;
};

OwnBlends& own_blends() {
  static OwnBlends all;
  return all;
}

float smoothstep(float t) { return t * t * (3 - 2 * t); }

// Symmetric about the middle; towards 1 the polynomial itself would lose its monotony to cancellation.
float smootherstep(float t) {
  const auto lower = [](float u) { return u * u * u * (u * (u * 6 - 15) + 10); };
  return t <= 0.5f ? lower(t) : 1 - lower(1 - t);
}

}  // namespace

std::span<const Blend> all_blends() { return blends; }

Blend own_blend(const BlendCurve& curve) { return own_blends().add(curve); }

const BlendCurve* curve_of(Blend blend) {
  const OwnBlends::Entry* const own = own_blends().find(blend);
  return own ? &own->curve : nullptr;
}

std::string_view name_of(Blend blend) {
  if (const OwnBlends::Entry* own = own_blends().find(blend)) return own->text;
  return names[static_cast<std::size_t>(blend)];
}

Blend blend_named(std::string_view name) {
  for (const Blend candidate : blends)
    if (name == name_of(candidate)) return candidate;
  if (is_curve_text(name)) return own_blend(blend_curve(name));
  throw InputError("unknown blending function '" + std::string(name) + "'; " +
                   known_names(name, {names.begin(), names.end()}) + "; or table:0,...,1 or polynomial:0,..., values " +
                   "or coefficients of your own");
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
    return own_blends().find(blend)->share(t);
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
  return own_blends().find(blend)->lipschitz;
}

}  // namespace lodestone
