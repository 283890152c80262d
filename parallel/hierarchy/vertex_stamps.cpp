#include "parallel/hierarchy/vertex_stamps.h"

#include <atomic>
#include <cassert>

#include "parallel/mesh/vertex_sharing.h"

namespace lodestone {
namespace {

// As take_vertex; one worker alone needs no atomic operation.
template <bool alone>
bool take(std::uint32_t& owner, CellRank rank) {
  if constexpr (!alone) return take_vertex(owner, rank);
  owner = rank;
  return true;
}

}  // namespace

void VertexStamps::collect_cell(const CellRuns& runs, CellRank rank, const TriangleSource& source, Scratch& s,
                                CellBuild& cell) {
  assert(cell.triangles.size() <= most_triangles);
  s.numbers.clear(cell.triangles.size() / 8);
  s.foreign.clear();
  if (s.ids.size() < 3 * cell.triangles.size()) s.ids.resize(3 * cell.triangles.size());
  const auto number = alone_ ? &VertexStamps::number_corners<true> : &VertexStamps::number_corners<false>;
  std::uint32_t count = 0;
  std::span<Triangle> out = cell.triangles;
  for (const Run& run : runs.runs_of(rank)) {
    count = (this->*number)(source.read(run, out.first(run.count)), rank, count, s, out.data());
    out = out.subspan(run.count);
  }
  cell.ids.assign(s.ids.begin(), s.ids.begin() + count);
}

// New vertices get ids from `count` on; returns how many there are then.
template <bool alone>
std::uint32_t VertexStamps::number_corners(std::span<const Triangle> triangles, CellRank rank, std::uint32_t count,
                                           Scratch& s, Triangle* to) {
  std::uint32_t* const sharing = sharing_.data();
  std::uint16_t* const id = id_.get();
  std::uint32_t* const ids = s.ids.data();
  for (const Triangle corners : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = corners.v[k];
      const std::uint32_t owner = std::atomic_ref(sharing[v]).load(std::memory_order_relaxed);
      std::uint32_t n = count;
      if ((owner & ~FinestVertices::shared_flag) == rank) {
        n = id[v];
      } else if (owner == unowned && take<alone>(sharing[v], rank)) {
        id[v] = static_cast<std::uint16_t>(n);
        ids[count++] = v;
      } else {
        n = number_foreign(v, count, s);
        count += n == count;
      }
      to->v[k] = n;
    }
    ++to;
  }
  return count;
}

// The id of a vertex that another cell has claimed: `count` if it is new. Rare; inlined, it would take registers from
// the frequent path.
[[gnu::noinline]] std::uint32_t VertexStamps::number_foreign(std::uint32_t v, std::uint32_t count, Scratch& s) {
  flag_shared(sharing_[v]);
  const std::uint32_t number = s.numbers.number(v);
  if (number == s.foreign.size()) {
    s.foreign.push_back(count);
    s.ids[count] = v;
  }
  return s.foreign[number];
}

}  // namespace lodestone
