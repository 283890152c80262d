// The scalar types of binary mesh files, by name; core/files/scalar.h reads them.
#pragma once

#include <cstdint>

namespace lodestone {

enum class ScalarType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

}  // namespace lodestone
