// The report as one HTML file that needs nothing else: style, script, plots, pictures and data are in it.
#pragma once

#include <cstdint>
#include <string>

#include "experiments/report/report.h"

namespace lodestone {

struct PageConfig {
  std::uint64_t picture_bytes = 16 << 20;  // of all pictures together, before they are encoded; 0: none
};

// Throws FileError when a picture cannot be read. Equal reports give equal bytes.
[[nodiscard]] std::string make_page(const Report& report, const PageConfig& config = {});

}  // namespace lodestone
