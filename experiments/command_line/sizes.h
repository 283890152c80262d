// Sizes as a user writes them: amounts of memory, and pictures.
#pragma once

#include <cstdint>
#include <string>

#include "render/camera/projection.h"

namespace lodestone {

// A positive number of bytes, as parse_byte_size (core/base/byte_size.h) reads it. Throws UsageError naming the option.
[[nodiscard]] std::uint64_t parse_bytes(const std::string& option, const std::string& text);

// "1280x720", each from 1 to 16384. Throws UsageError naming the option.
[[nodiscard]] ImageSize parse_image_size(const std::string& option, const std::string& text);

}  // namespace lodestone
