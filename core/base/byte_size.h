// Sizes in bytes as people write them, the same for all options.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace lodestone {

inline constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20;

// "2GiB", "1500MB", "4G", "1048576": a positive number and a unit, in any case. kB, MB, GB, TB are powers of 1000; KiB,
// MiB, GiB, TiB and K, M, G, T powers of 1024. Empty for anything else and for 2^63 bytes and more.
[[nodiscard]] std::optional<std::uint64_t> parse_byte_size(std::string_view text);

// A need and what there is for it, in messages: "97 MiB", rounded up, and "96.99 MiB", rounded down, so that the need
// is never printed as the same number.
[[nodiscard]] std::string needed_mebibytes(std::uint64_t bytes);
[[nodiscard]] std::string available_mebibytes(std::uint64_t bytes);

}  // namespace lodestone
