// The quadric kernel for processors with AVX2. Only this file is compiled for them.
#if defined(__AVX2__)
#include "core/simplify/quadric/quadric_kernel.h"

const lodestone::quadric::BlockKernel lodestone::quadric::avx2_kernel = avx2::simplify_block;
#else
#include "core/simplify/quadric/block_arrays.h"

const lodestone::quadric::BlockKernel lodestone::quadric::avx2_kernel = nullptr;
#endif
