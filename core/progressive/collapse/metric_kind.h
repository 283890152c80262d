// The measures by which a mesh can be made progressive, by name.
#pragma once

#include <cstdint>
#include <string_view>

namespace lodestone::progressive {

enum class MetricKind : std::uint32_t { quadric = 0, attribute_quadric = 1, parametric = 2 };
[[nodiscard]] MetricKind metric_kind(std::string_view name);  // throws InputError listing the known names
[[nodiscard]] std::string_view name_of(MetricKind kind);

// Weights of attributes for attribute_quadric, as lengths in extents of the model; 0 if they do not count.
struct AttributeWeights {
  double normal = 0.01;  // for a normal turned by a radian
  double colour = 0.05;  // for a channel that goes from nothing to full
  double uv = 0.5;       // times the distance that the texture slides on the surface
};

}  // namespace lodestone::progressive
