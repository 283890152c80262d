// Files of this folder that are part of the program.
#pragma once

#include <string_view>

namespace lodestone {

[[nodiscard]] std::string_view plot_script();    // plot.py
[[nodiscard]] std::string_view report_style();   // report.css
[[nodiscard]] std::string_view report_script();  // report.js

}  // namespace lodestone
