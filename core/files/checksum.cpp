#include "core/files/checksum.h"

#define XXH_INLINE_ALL  // header only: users of the installed library need not find or link it
#include <xxhash.h>

namespace lodestone {

std::uint64_t checksum(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

}  // namespace lodestone
