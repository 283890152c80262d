// Checksums that detect damaged, truncated or missing bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace lodestone {

[[nodiscard]] std::uint64_t checksum(std::span<const std::byte> bytes);  // XXH3, 64 bits

// The polynomial of zlib, ZIP and PNG (ISO 3309).
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes);

}  // namespace lodestone
