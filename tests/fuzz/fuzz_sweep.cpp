// Sweeps in TOML: any text gives a sweep, in each of its forms, or an Error.
#include <cstdint>

#include "core/base/error.h"
#include "experiments/sweep/sweep_file.h"
#include "tests/fuzz/memory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  const MemoryFile file(data, size);
  for (const SweepForm form : {SweepForm::small, SweepForm::standard, SweepForm::full}) {
    try {
      (void)load_sweep_file(file.path(), form);
    } catch (const Error&) {
    }
  }
  return 0;
}
