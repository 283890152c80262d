// Any bytes give a material library or an Error.
#include <cstdint>
#include <cstdlib>

#include "core/base/error.h"
#include "core/formats/obj/obj_materials.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    lodestone::ByteReader input({reinterpret_cast<const char*>(data), size}, "fuzz");
    for (const lodestone::MtlMaterial& material : lodestone::read_mtl(input))
      for (const float c : material.colour)
        if (!(c >= 0 && c <= 1)) std::abort();
  } catch (const lodestone::Error&) {
  }
  return 0;
}
