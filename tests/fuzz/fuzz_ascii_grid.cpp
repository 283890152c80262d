#include "tests/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lodestone::fuzz_reader(data, size, lodestone::MeshFormat::ascii_grid);
}
