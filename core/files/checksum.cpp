#include "core/files/checksum.h"

#define XXH_INLINE_ALL  // header only: nothing to link, nothing to find for those who install the library
#include <xxhash.h>

namespace lodestone {

std::uint64_t checksum(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

}  // namespace lodestone
