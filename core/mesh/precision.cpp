#include "core/mesh/precision.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

namespace lodestone {
namespace {

constexpr std::size_t sample_size = 4096;
constexpr double enough_steps = 65536;

struct MiddleRange {
  float low = 0, high = 0;
};

// The interval that holds all values but half a percent at each end.
MiddleRange middle_of(std::vector<float>& values) {
  const auto place = [&](double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  return {place(0.005), place(0.995)};
}

double step_at(float value, Lattice lattice) {
  if (lattice) return lattice.step();
  return double{value} - double{std::nextafter(value, -1.0f)};
}

double component(Vec3f p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

}  // namespace

std::optional<CrowdedModel> find_crowded(std::span<const Vec3f> positions, const Transform& transform) {
  if (positions.empty()) return std::nullopt;
  const std::size_t stride = 1 + (positions.size() - 1) / sample_size;
  std::array<MiddleRange, 3> box;
  CrowdedModel crowded;
  double step = 0;
  std::vector<float> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (std::size_t i = 0; i < positions.size(); i += stride)
      values.push_back(static_cast<float>(component(positions[i], axis)));
    const MiddleRange middle = box[static_cast<std::size_t>(axis)] = middle_of(values);
    crowded.share = std::max(crowded.share, double{middle.high} - double{middle.low});
    step = std::max(step, step_at(middle.high, transform.lattice));
  }
  crowded.steps = crowded.share / step;
  if (crowded.steps >= enough_steps || !(crowded.share > 0)) return std::nullopt;
  crowded.step = step * transform.scale;
  Vec3f farthest;
  double largest = -1;
  for (const Vec3f& p : positions) {
    double squared = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const MiddleRange& side = box[static_cast<std::size_t>(axis)];
      const double away = component(p, axis) - 0.5 * (double{side.low} + double{side.high});
      squared += away * away;
    }
    if (squared > largest) largest = squared, farthest = p;
  }
  crowded.farthest = transform.to_model(farthest);
  return crowded;
}

std::string describe(const CrowdedModel& model) {
  std::array<char, 512> text{};
  const Vec3d p = model.farthest;
  std::snprintf(text.data(), text.size(),
                "99 %% of the vertices lie within %.2g of the longest extent, where float32 tells %.3g steps of %.3g "
                "apart (%.1f decimal digits; 7.2 are usual): details below that are lost; remove vertices that are far "
                "away, of which the farthest is at (%.9g, %.9g, %.9g), or build that part alone",
                model.share, model.steps, model.step, std::log10(std::max(model.steps, 1.0)), p.x, p.y, p.z);
  return text.data();
}

}  // namespace lodestone
