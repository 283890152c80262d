// Benchmarks take memory as the program does.
#include "experiments/large_memory.h"

namespace {

[[maybe_unused]] const bool kept = (lodestone::keep_large_memory(), true);

}  // namespace
