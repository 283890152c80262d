// Camera paths in JSON: any text gives cameras that are finite, also between the keys, or an Error.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "core/base/error.h"
#include "render/camera/camera.h"
#include "tests/fuzz/json_mutator.h"
#include "tests/fuzz/memory_file.h"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  return lodestone::mutate_json(data, size, max_size, seed);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  const MemoryFile file(data, size);
  try {
    for (const Camera& camera : read_camera_path(file.path(), 7)) {
      if (!is_finite(camera.position) || !is_finite(camera.target) || !std::isfinite(camera.vertical_fov)) std::abort();
      if (camera.position == camera.target) std::abort();
    }
  } catch (const Error&) {
  }
  return 0;
}
