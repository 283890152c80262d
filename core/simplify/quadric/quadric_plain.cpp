// The quadric kernel for any processor.
#include "core/simplify/quadric/quadric_kernel.h"

namespace lodestone::quadric {

const BlockKernel plain_kernel = plain::simplify_block;

}  // namespace lodestone::quadric
