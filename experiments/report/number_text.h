// Numbers for people: four digits, thousands apart, bytes as MiB.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace lodestone {

// 1234567 -> "1,234,567", 0.0123456 -> "0.01235", 1.5e-7 -> "1.5e-07". Whole numbers keep all their digits.
[[nodiscard]] std::string number_text(double value);

// The same for numbers; texts as they are, "yes" and "no", and a dash for null.
[[nodiscard]] std::string value_text(const nlohmann::json& value);

// "1 run", "2 runs".
[[nodiscard]] std::string counted(std::size_t count, const std::string& noun);

// How values of a unit are shown: under another name, and divided.
struct ShownUnit {
  std::string name;
  double divisor = 1;
};
[[nodiscard]] ShownUnit shown_unit(const std::string& unit);

}  // namespace lodestone
