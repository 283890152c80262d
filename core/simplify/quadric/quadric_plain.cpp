// The quadric kernel for any processor.
#include "core/simplify/quadric/lanes_plain.h"
#include "core/simplify/quadric/quadric_kernel.h"

namespace lodestone::quadric {

void simplify_block_plain(const SimplifyInput& input, Placement placement, Arrays& arrays, Piles& piles, Seams* seams,
                          SimplifyResult& result) {
  BlockKernel<plain::Lanes>(input, placement, arrays, piles, seams, result).run();
}

}  // namespace lodestone::quadric
