#include "core/formats/common/colour.h"

namespace lodestone {

const std::array<float, 256>& linear_of_srgb() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> linear{};
    for (std::size_t i = 0; i < linear.size(); ++i) {
      const float c = static_cast<float>(i) / 255;
      linear[i] = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
    }
    return linear;
  }();
  return table;
}

}  // namespace lodestone
