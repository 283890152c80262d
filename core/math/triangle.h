// Triangles as plain data.
#pragma once

#include <array>
#include <cstdint>

namespace lodestone {

// Three vertex ids, counter-clockwise seen from outside. What they index is said where a Triangle is used.
struct Triangle {
  std::array<std::uint32_t, 3> v{};
  friend constexpr bool operator==(const Triangle&, const Triangle&) = default;
};

[[nodiscard]] constexpr bool is_degenerate(const Triangle& t) {
  return t.v[0] == t.v[1] || t.v[1] == t.v[2] || t.v[2] == t.v[0];
}

}  // namespace lodestone
