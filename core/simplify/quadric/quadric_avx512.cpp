// The quadric kernel for processors with AVX-512. Only this file is compiled for them.
#include "core/base/instruction_set.h"

#if defined(LODESTONE_AVX512)
#include "core/simplify/quadric/quadric_kernel.h"

const lodestone::quadric::BlockKernel lodestone::quadric::avx512_kernel = avx512::simplify_block;
#else
#include "core/simplify/quadric/block_arrays.h"

const lodestone::quadric::BlockKernel lodestone::quadric::avx512_kernel = nullptr;
#endif
