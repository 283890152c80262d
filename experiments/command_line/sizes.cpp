#include "experiments/command_line/sizes.h"

#include <cstdio>
#include <optional>

#include "core/base/byte_size.h"
#include "core/base/error.h"
#include "experiments/command_line/exit_status.h"

namespace lodestone {

std::uint64_t parse_bytes(const std::string& option, const std::string& text) {
  if (const std::optional<std::uint64_t> bytes = parse_byte_size(text)) return *bytes;
  throw UsageError(
      describe(option, "", "'" + text + "' is not a size", "give a number and a unit, such as 2GiB or 1500MB"));
}

ImageSize parse_image_size(const std::string& option, const std::string& text) {
  ImageSize size;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &rest) == 2 && size.width >= 1 &&
      size.height >= 1 && size.width <= 16384 && size.height <= 16384)
    return size;
  throw UsageError(
      describe(option, "", "'" + text + "' is not a picture size", "write WIDTHxHEIGHT, each from 1 to 16384"));
}

}  // namespace lodestone
