// A tileset without any file beside it: bytes in memory have no folder, so that every tile is missing.
#include <cstdint>

#include "core/base/error.h"
#include "core/formats/tiles/tileset.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    lodestone::ByteReader input({reinterpret_cast<const char*>(data), size}, "fuzz");
    (void)lodestone::list_tiles(input);
  } catch (const lodestone::Error&) {
  }
  return 0;
}
