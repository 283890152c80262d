// Effects that a picture can show besides the bare surface, as a set of switches.
//
// An effect that is switched on does its work; its result follows from the scene's parameters (render/frame/frame.h),
// and if those ask for nothing it changes no bit. So a plan that switches off the effects that a scene does not call
// for (render/effects/plan.h) gives the picture of a plan that has everything on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string_view>

namespace lodestone {

// The effects in the order in which they are applied to a pixel.
enum class Effect : std::uint8_t {
  geomorph,
  smooth_normals,
  vertex_colours,
  texture,
  normal_map,
  occlusion_map,
  level_tint,
  head_light,
  directional_light,
  shadow,
  unlit,
  emission,
  wireframe,
  fog,
  transparency,
  ambient_occlusion,
  overdraw,
};
inline constexpr std::size_t effect_count = static_cast<std::size_t>(Effect::overdraw) + 1;

inline constexpr std::array<std::string_view, effect_count> effect_names{
    "geomorph",     "smooth-normals",    "vertex-colours", "texture", "normal-map", "occlusion-map", "level-tint",
    "head-light",   "directional-light", "shadow",         "unlit",   "emission",   "wireframe",     "fog",
    "transparency", "ambient-occlusion", "overdraw"};

[[nodiscard]] constexpr std::string_view name_of(Effect effect) {
  return effect_names[static_cast<std::size_t>(effect)];
}

// Empty for an unknown name.
[[nodiscard]] constexpr std::optional<Effect> effect_named(std::string_view name) {
  for (std::size_t k = 0; k < effect_count; ++k)
    if (effect_names[k] == name) return static_cast<Effect>(k);
  return std::nullopt;
}

class EffectSet {
 public:
  constexpr EffectSet() = default;
  constexpr EffectSet(std::initializer_list<Effect> effects) {
    for (const Effect effect : effects) insert(effect);
  }
  [[nodiscard]] static constexpr EffectSet all() {
    EffectSet set;
    set.bits_ = (1u << effect_count) - 1;
    return set;
  }

  constexpr void insert(Effect effect) { bits_ |= bit(effect); }
  constexpr void erase(Effect effect) { bits_ &= ~bit(effect); }
  constexpr void set(Effect effect, bool on) { on ? insert(effect) : erase(effect); }
  [[nodiscard]] constexpr bool contains(Effect effect) const { return (bits_ & bit(effect)) != 0; }
  [[nodiscard]] constexpr bool contains_any(EffectSet other) const { return (bits_ & other.bits_) != 0; }
  [[nodiscard]] constexpr bool empty() const { return bits_ == 0; }
  [[nodiscard]] constexpr std::uint32_t bits() const { return bits_; }

  friend constexpr EffectSet operator|(EffectSet a, EffectSet b) { return from_bits(a.bits_ | b.bits_); }
  friend constexpr EffectSet operator&(EffectSet a, EffectSet b) { return from_bits(a.bits_ & b.bits_); }
  friend constexpr auto operator<=>(const EffectSet&, const EffectSet&) = default;

 private:
  [[nodiscard]] static constexpr std::uint32_t bit(Effect effect) { return 1u << static_cast<unsigned>(effect); }
  [[nodiscard]] static constexpr EffectSet from_bits(std::uint32_t bits) {
    EffectSet set;
    set.bits_ = bits;
    return set;
  }
  std::uint32_t bits_ = 0;
};

}  // namespace lodestone
