#include "parallel/mesh/refine_mesh.h"

#include <vector>

namespace lodestone {
namespace {

constexpr std::size_t refine_grain = std::size_t{1} << 16;

// Joins the results of find(begin, end) for all chunks, in order.
template <class T, class Find>
std::vector<T> gathered(std::size_t count, Scheduler& scheduler, const Find& find) {
  std::vector<std::vector<T>> chunks(chunk_count(count, refine_grain));
  scheduler.for_chunks(count, refine_grain,
                       [&](ChunkRange range) { chunks[range.index] = find(range.begin, range.end); });
  std::vector<T> all;
  for (const std::vector<T>& chunk : chunks) all.insert(all.end(), chunk.begin(), chunk.end());
  return all;
}

}  // namespace

RefineReport refine_mesh(IndexedMesh& mesh, double longest, Scheduler& scheduler) {
  EdgeSplitter splitter(mesh, longest);
  const std::size_t vertices = mesh.positions.size();
  splitter.split(gathered<std::uint32_t>(mesh.triangles.size(), scheduler, [&](std::size_t begin, std::size_t end) {
    return splitter.long_triangles(begin, end);
  }));
  return splitter.finish(gathered<EdgeSplitter::Meeting>(
      vertices, scheduler, [&](std::size_t begin, std::size_t end) { return splitter.meetings(begin, end); }));
}

}  // namespace lodestone
