// The quadric kernel for processors with AVX-512 and its byte and word lanes. Only this file is compiled for them.
#if defined(__AVX512VL__) && defined(__AVX512BW__) && defined(__AVX512VBMI2__)
#include "core/simplify/quadric/quadric_kernel.h"

const lodestone::quadric::BlockKernel lodestone::quadric::avx512_kernel = avx512::simplify_block;
#else
#include "core/simplify/quadric/block_arrays.h"

const lodestone::quadric::BlockKernel lodestone::quadric::avx512_kernel = nullptr;
#endif
