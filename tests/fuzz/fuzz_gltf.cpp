// Text or binary glTF. A few bytes of JSON may show one mesh many times, so that no count follows from the size.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/base/error.h"
#include "core/formats/gltf/gltf.h"
#include "tests/core/mesh/wedge_checks.h"
#include "tests/fuzz/json_mutator.h"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  return lodestone::mutate_json(data, size, max_size, seed);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    ByteReader input({bytes.data(), bytes.size()}, "fuzz");
    const RawMesh mesh = read_gltf(input);
    if (!wedge_mistake(mesh).empty()) std::abort();
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t id : t.v)
        if (id >= mesh.positions.size()) std::abort();
  } catch (const Error&) {
  }
  return 0;
}
