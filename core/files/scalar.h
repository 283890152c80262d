// The scalar types of binary mesh files, in either byte order.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "core/files/scalar_type.h"

namespace lodestone {

static_assert(std::endian::native == std::endian::little, "the binary formats are decoded on little-endian machines");

[[nodiscard]] constexpr std::size_t size_of(ScalarType type) {
  constexpr std::array<std::uint8_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}
[[nodiscard]] constexpr bool is_integer(ScalarType type) { return type < ScalarType::float32; }

// Reads a T at any alignment. The swap is a built-in on integers: swapping bytes in a loop keeps the compiler's
// vectorizer busy for minutes.
template <class T, std::endian order = std::endian::little>
[[nodiscard]] T load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  if constexpr (order == std::endian::little || sizeof(T) == 1) {
    return value;
  } else if constexpr (sizeof(T) == 2) {
    return std::bit_cast<T>(__builtin_bswap16(std::bit_cast<std::uint16_t>(value)));
  } else if constexpr (sizeof(T) == 4) {
    return std::bit_cast<T>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
  } else {
    return std::bit_cast<T>(__builtin_bswap64(std::bit_cast<std::uint64_t>(value)));
  }
}

// Calls visit with a value of the C++ type that `type` stands for, and returns what it returns.
template <class Visit>
auto with_scalar_type(ScalarType type, Visit&& visit) {
  switch (type) {
    case ScalarType::int8:
      return visit(std::int8_t{});
    case ScalarType::uint8:
      return visit(std::uint8_t{});
    case ScalarType::int16:
      return visit(std::int16_t{});
    case ScalarType::uint16:
      return visit(std::uint16_t{});
    case ScalarType::int32:
      return visit(std::int32_t{});
    case ScalarType::uint32:
      return visit(std::uint32_t{});
    case ScalarType::float32:
      return visit(float{});
    case ScalarType::float64:
      break;
  }
  return visit(double{});
}

// Reads a scalar of a type known at run time as Value: int64 (of integer types) or double holds each of them exactly.
template <class Value>
[[nodiscard]] Value load_as(ScalarType type, std::endian order, const char* bytes) {
  return with_scalar_type(type, [&](auto zero) {
    using T = decltype(zero);
    return static_cast<Value>(order == std::endian::big ? load<T, std::endian::big>(bytes) : load<T>(bytes));
  });
}

}  // namespace lodestone
