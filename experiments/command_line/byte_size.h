// Options that take a size in bytes.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "core/base/byte_size.h"

namespace lodestone {

// For CLI::Option::transform: turns "2GiB" into a number of bytes.
[[nodiscard]] inline CLI::Validator byte_size() {
  return CLI::Validator(
      [](std::string& text) -> std::string {
        const std::optional<std::uint64_t> bytes = parse_byte_size(text);
        if (!bytes) return "'" + text + "' is not a size; give a number and a unit, such as 2GiB or 1500MB";
        text = std::to_string(*bytes);
        return {};
      },
      "");
}

}  // namespace lodestone
