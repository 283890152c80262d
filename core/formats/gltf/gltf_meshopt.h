// The glTF extension EXT_meshopt_compression.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/files/json_view.h"

namespace lodestone {

// Most bytes that one compressed byte can hold: the codec of vertices stores 16 equal bytes in 2 bits; that of triangles
// takes at least a byte for three indices.
inline constexpr std::uint64_t meshopt_densest = 64;

// The elements of a buffer view, decoded by meshoptimizer and unfiltered; `extension` describes them (mode, count,
// stride, filter), `packed` has their bytes. Throws InputError naming the place if they contradict the extension or
// cannot be decoded; allocates no more memory than the densest coding of `packed` can hold.
[[nodiscard]] std::vector<char> decompress_meshopt(const JsonView& extension, std::span<const char> packed);

// The inverse: elements of vertices (mode ATTRIBUTES; `stride` a multiple of 4), or indices (mode INDICES), which
// keep their order.
[[nodiscard]] std::vector<std::byte> compress_meshopt(std::span<const std::byte> bytes, std::size_t count,
                                                      std::size_t stride, bool indices);

}  // namespace lodestone
