// Lists of items on their way to another rank, in fewer bytes: most words of an item differ little from those of the
// one before, as numbers of vertices and coordinates do where the input has an order.
#pragma once

#include <cstddef>
#include <span>

#include "parallel/distributed/messages/transport.h"

namespace lodestone {

// The differences to the words one item before, in as many bytes as they need, after two bits for each that tell how
// many (lemire2018); or the bytes as they are, where that is shorter or they are not words of 32 bits.
[[nodiscard]] Message pack_words(std::span<const std::byte> items, std::size_t item_bytes);

// The items again. Throws Error for bytes that pack_words does not give.
[[nodiscard]] Message unpack_words(std::span<const std::byte> packed, std::size_t item_bytes);

}  // namespace lodestone
