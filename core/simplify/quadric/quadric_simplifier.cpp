#include "core/simplify/quadric/quadric_simplifier.h"

#include <algorithm>
#include <cstdlib>
#include <new>
#include <numeric>

#include "core/base/error.h"
#include "core/simplify/quadric/block_arrays.h"
#include "core/simplify/quadric/nonmanifold_stars.h"
#include "core/simplify/quadric/seams.h"
#include "core/simplify/quadric/splitter.h"

namespace lodestone {

namespace quadric {

// The system hands out zeroed pages on first touch, so that a small block takes little memory; calloc relies on that,
// operator new would touch them all.
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
  QuadricSimplifier(quadric::BlockKernel kernel, Placement placement)
      : placement_(placement), kernel_(kernel), arrays_(quadric::allocate_arrays()) {}

  const SimplifyResult& simplify(const SimplifyInput& input) override {
    result_.parent.resize(input.positions.size());
    result_.positions.resize(input.positions.size());
    result_.distance.resize(input.positions.size());
    result_.wedge_parent.clear();
    if (input.positions.size() <= quadric::id_limit) {
      kernel_(input, placement_, memory_for(input), result_);
    } else {
      simplify_parts(input);
    }
    return result_;
  }
  [[nodiscard]] bool knows_wedges() const override { return true; }

 private:
  quadric::BlockMemory memory_for(const SimplifyInput& input) {
    return {*arrays_, nonmanifold_, input.wedge_vertex.empty() ? nullptr : &seams_};
  }

  // Vertices on the seams between parts are kept for this call; the next level cuts elsewhere.
  void simplify_parts(const SimplifyInput& input) {
    for (std::uint32_t v = 0; v < input.positions.size(); ++v) result_.parent[v] = v;
    std::copy(input.positions.begin(), input.positions.end(), result_.positions.begin());
    std::fill(result_.distance.begin(), result_.distance.end(), 0.0f);
    result_.wedge_parent.resize(input.wedge_vertex.size());
    std::iota(result_.wedge_parent.begin(), result_.wedge_parent.end(), 0u);
    result_.triangles = 0;
    const std::size_t parts = splitter_.split(input, quadric::id_limit);
    for (std::size_t p = 0; p < parts; ++p) {
      const quadric::Part& part = splitter_.part(input, p);
      const double share = static_cast<double>(part.triangles.size()) / static_cast<double>(input.triangles.size());
      const auto target = static_cast<std::size_t>(share * static_cast<double>(input.target_triangles));
      of_part_.parent.resize(part.vertices.size());
      of_part_.positions.resize(part.vertices.size());
      of_part_.distance.resize(part.vertices.size());
      const SimplifyInput part_input = part.input(input, target);
      kernel_(part_input, placement_, memory_for(part_input), of_part_);
      for (std::size_t v = 0; v < part.vertices.size(); ++v) {
        result_.parent[part.vertices[v]] = part.vertices[of_part_.parent[v]];
        result_.positions[part.vertices[v]] = of_part_.positions[v];
        result_.distance[part.vertices[v]] = of_part_.distance[v];
      }
      for (std::size_t w = 0; w < part.wedges.size(); ++w)
        result_.wedge_parent[part.wedges[w]] = part.wedges[of_part_.wedge_parent[w]];
      result_.triangles += of_part_.triangles;
    }
  }

  Placement placement_;
  quadric::BlockKernel kernel_;
  std::unique_ptr<quadric::Arrays, quadric::FreeArrays> arrays_;
  quadric::NonmanifoldStars nonmanifold_;
  quadric::Seams seams_;
  quadric::Splitter splitter_;
  SimplifyResult result_, of_part_;
};

}  // namespace

std::unique_ptr<Simplifier> make_quadric_simplifier(InstructionSet set, Placement placement) {
  return std::make_unique<QuadricSimplifier>(
      choose_kernel(set, quadric::plain_kernel, quadric::avx2_kernel, quadric::avx512_kernel), placement);
}

}  // namespace lodestone
