// A checksum that detects damaged, truncated or missing bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace lodestone {

[[nodiscard]] std::uint64_t checksum(std::span<const std::byte> bytes);  // XXH3, 64 bits

}  // namespace lodestone
