// The quadric kernel for any processor.
#include "core/simplify/lanes_plain.h"
#include "core/simplify/quadric_kernel.h"

namespace lodestone::quadric {

void simplify_block_plain(const SimplifyInput& input, Placement placement, Arrays& arrays, Seams* seams,
                          SimplifyResult& result) {
  BlockKernel<plain::Lanes>(input, placement, arrays, seams, result).run();
}

}  // namespace lodestone::quadric
