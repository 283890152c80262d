// How an image continues beyond its sides.
#pragma once

#include <cstdint>

#include "core/mesh/attributes.h"

namespace lodestone {

// The index of texel i among n, for any i.
[[nodiscard]] std::uint32_t wrapped(std::int64_t i, std::uint32_t n, TextureWrap wrap);

}  // namespace lodestone
