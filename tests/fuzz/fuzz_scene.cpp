// Scenes in TOML: any text gives a scene or an Error.
#include <cstdint>

#include "core/base/error.h"
#include "render/scene/scene_file.h"
#include "tests/fuzz/memory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const lodestone::MemoryFile file(data, size);
  try {
    (void)lodestone::read_scene(file.path());
  } catch (const lodestone::Error&) {
  }
  return 0;
}
