#include "core/simplify/quadric_simplifier.h"

#include <cstdlib>
#include <new>

#include "core/base/error.h"
#include "core/simplify/quadric_block.h"
#include "core/simplify/quadric_parts.h"

namespace lodestone {

namespace quadric {

// The system hands out zeroed pages on first touch, so that a small block stays small; calloc says so, operator new
// would touch them all.
std::unique_ptr<Arrays, FreeArrays> allocate_arrays() {
  void* memory = std::calloc(1, sizeof(Arrays) + alignof(Arrays));
  if (memory == nullptr) throw ResourceError(describe("", "quadric simplifier", "no memory for its arrays"));
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t aligned = (address + alignof(Arrays) - 1) / alignof(Arrays) * alignof(Arrays);
  return {reinterpret_cast<Arrays*>(aligned), FreeArrays{memory}};
}

}  // namespace quadric

namespace {

class QuadricSimplifier final : public Simplifier {
 public:
  explicit QuadricSimplifier(bool avx2)
      : kernel_(avx2 ? quadric::simplify_block_avx2 : quadric::simplify_block_plain),
        arrays_(quadric::allocate_arrays()) {}

  const SimplifyResult& simplify(const SimplifyInput& input) override {
    result_.parent.resize(input.positions.size());
    result_.positions.resize(input.positions.size());
    if (input.positions.size() <= quadric::id_limit) {
      kernel_(input, *arrays_, result_);
    } else {
      quadric::simplify_in_parts(
          input, quadric::id_limit,
          [this](const SimplifyInput& part, SimplifyResult& result) { kernel_(part, *arrays_, result); }, parts_,
          result_);
    }
    return result_;
  }

 private:
  void (*kernel_)(const SimplifyInput&, quadric::Arrays&, SimplifyResult&);
  std::unique_ptr<quadric::Arrays, quadric::FreeArrays> arrays_;
  quadric::PartsScratch parts_;
  SimplifyResult result_;
};

}  // namespace

bool is_available(InstructionSet set) {
#if defined(__x86_64__)
  return set != InstructionSet::avx2 || __builtin_cpu_supports("avx2");
#else
  return set != InstructionSet::avx2;
#endif
}

std::unique_ptr<Simplifier> make_quadric_simplifier(InstructionSet set) {
  if (!is_available(set))
    throw UnsupportedError(describe("", "quadric simplifier", "this processor has no AVX2", "use the plain kernel"));
  return std::make_unique<QuadricSimplifier>(set != InstructionSet::plain && is_available(InstructionSet::avx2));
}

}  // namespace lodestone
