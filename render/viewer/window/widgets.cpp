#include "render/viewer/window/widgets.h"

#include <cstdio>

namespace lodestone::viewer {

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

std::string count_text(std::uint64_t n) {
  if (n >= 10'000'000) return text("%.1f M", static_cast<double>(n) * 1e-6);
  if (n >= 10'000) return text("%.1f k", static_cast<double>(n) * 1e-3);
  return std::to_string(n);
}

}  // namespace lodestone::viewer
