#include "experiments/report/number_text.h"

#include <fmt/core.h>

#include <cmath>

namespace lodestone {

std::string number_text(double value) {
  if (!std::isfinite(value)) return std::isnan(value) ? "not a number" : value > 0 ? "infinite" : "-infinite";
  const bool whole = value == std::round(value);
  if (!whole || std::abs(value) >= 1e15) {
    // Four digits; what they show as a whole number of thousands is no longer read as one.
    return std::abs(value) >= 9999.5 && std::abs(value) < 1e15 ? number_text(std::round(value))
                                                               : fmt::format("{:.4g}", value);
  }
  std::string text = fmt::format("{:.0f}", std::abs(value));
  for (int place = static_cast<int>(text.size()) - 3; place > 0; place -= 3)
    text.insert(static_cast<std::size_t>(place), 1, ',');
  return value < 0 ? "-" + text : text;
}

std::string value_text(const nlohmann::json& value) {
  if (value.is_null()) return "–";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_string()) return value.get<std::string>();
  return value.is_number() ? number_text(value.get<double>()) : value.dump();
}

std::string counted(std::size_t count, const std::string& noun) {
  return number_text(static_cast<double>(count)) + " " + noun + (count == 1 ? "" : "s");
}

ShownUnit shown_unit(const std::string& unit) {
  if (unit == "bytes" || unit == "B") return {"MiB", 1024.0 * 1024.0};
  return {unit, 1};
}

}  // namespace lodestone
