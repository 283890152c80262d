#include "core/base/byte_size.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace lodestone {

std::optional<std::uint64_t> parse_byte_size(std::string_view text) {
  double number = 0;
  const auto [unit, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || !(number > 0) || !std::isfinite(number)) return std::nullopt;
  std::string name(unit, text.data() + text.size());
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  const std::size_t power = name.empty() || name == "b" ? 0 : std::string_view(" kmgt").find(name.front(), 1);
  if (power == std::string_view::npos) return std::nullopt;
  const std::string rest = power == 0 ? "" : name.substr(1);
  if (!rest.empty() && rest != "b" && rest != "ib") return std::nullopt;
  const double bytes = number * std::pow(rest == "b" ? 1000.0 : 1024.0, static_cast<double>(power));
  if (!(bytes < 0x1p63)) return std::nullopt;
  return static_cast<std::uint64_t>(bytes);
}

std::string needed_mebibytes(std::uint64_t bytes) { return std::to_string((bytes + mebibyte - 1) / mebibyte) + " MiB"; }

std::string available_mebibytes(std::uint64_t bytes) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.15g MiB", std::floor(static_cast<double>(bytes) / mebibyte * 100) / 100);
  return text.data();
}

}  // namespace lodestone
