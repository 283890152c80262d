// The quadric kernel for processors with AVX2. Only this file is compiled for them; without that (other processors,
// other compilers) it is the plain kernel under the other name, and nothing asks for it.
#if defined(__AVX2__)

#include "core/simplify/quadric/lanes_avx2.h"
#include "core/simplify/quadric/quadric_kernel.h"

namespace lodestone::quadric {

void simplify_block_avx2(const SimplifyInput& input, Placement placement, Arrays& arrays, Piles& piles, Seams* seams,
                         SimplifyResult& result) {
  BlockKernel<avx2::Lanes>(input, placement, arrays, piles, seams, result).run();
}

}  // namespace lodestone::quadric

#else

#include "core/simplify/quadric/quadric_block.h"

namespace lodestone::quadric {

void simplify_block_avx2(const SimplifyInput& input, Placement placement, Arrays& arrays, Piles& piles, Seams* seams,
                         SimplifyResult& result) {
  simplify_block_plain(input, placement, arrays, piles, seams, result);
}

}  // namespace lodestone::quadric

#endif
