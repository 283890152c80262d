#include "parallel/mesh/vertex_sharing.h"

#include <numeric>
#include <vector>

namespace lodestone {

std::size_t number_shared(std::span<std::uint32_t> sharing, Scheduler& scheduler) {
  constexpr std::size_t grain = 1 << 18;
  std::vector<std::size_t> first(chunk_count(sharing.size(), grain) + 1, 0);
  scheduler.for_chunks(sharing.size(), grain, [&](ChunkRange range) {
    for (std::size_t v = range.begin; v < range.end; ++v) first[range.index + 1] += sharing[v] >> 31;
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  scheduler.for_chunks(sharing.size(), grain, [&](ChunkRange range) {
    auto next = static_cast<std::uint32_t>(first[range.index]);
    for (std::size_t v = range.begin; v < range.end; ++v)
      if (sharing[v] & FinestVertices::shared_flag) sharing[v] = FinestVertices::shared_flag | next++;
  });
  return first.back();
}

}  // namespace lodestone
