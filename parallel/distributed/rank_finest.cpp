#include "parallel/distributed/rank_finest.h"

#include <algorithm>
#include <utility>

#include "parallel/distributed/messages/pieces.h"
#include "parallel/hierarchy/finest_level.h"
#include "parallel/hierarchy/partition.h"
#include "parallel/hierarchy/shared_vertices.h"

namespace lodestone {
namespace {

// A vertex that triangles of several ranks use: what one of them, or all together, know of it.
struct SharedItem {
  std::uint32_t id;
  SharedSum sum;
};

struct SharedReply {
  int to;
  SharedItem item;
};

// Sends the sums of a rank to the ranks of the ids, and calls take(item) with those of all ranks together.
template <class Take>
void join_sums(std::span<const SharedItem> own, const Slices& vertices, Ranks& ranks, const Take& take) {
  std::vector<SharedReply> came;  // by rank that they came from
  exchange_in_pieces<SharedItem>(
      ranks, own.size(), [&](std::uint64_t i, const auto& emit) { emit(vertices.owner(own[i].id), own[i]); },
      [&](int from, const std::vector<SharedItem>& some) {
        for (const SharedItem& item : some) came.push_back({from, item});
      });
  std::ranges::sort(came, {}, [](const SharedReply& reply) { return std::pair(reply.item.id, reply.to); });
  for (auto first = came.begin(); first != came.end();) {
    const auto last =
        std::find_if(first, came.end(), [&](const SharedReply& r) { return r.item.id != first->item.id; });
    for (auto other = first + 1; other != last; ++other) first->item.sum.add(other->item.sum);
    for (auto other = first + 1; other != last; ++other) other->item.sum = first->item.sum;
    first = last;
  }
  exchange_in_pieces<SharedItem>(
      ranks, came.size(), [&](std::uint64_t i, const auto& emit) { emit(came[i].to, came[i].item); },
      [&](int, const std::vector<SharedItem>& some) {
        for (const SharedItem& item : some) take(item);
      });
}

}  // namespace

void join_shared(const OuterVertices& outer, const FinestVertices& all, const Slices& slices, SharedVertices& shared,
                 Ranks& ranks) {
  const auto number = [&](std::uint32_t v) { return all.sharing[v] & ~FinestVertices::shared_flag; };
  std::vector<SharedItem> own;
  own.reserve(outer.size());
  for (const auto& [id, v] : outer) own.push_back({id, shared.sum(number(v))});
  join_sums(own, slices, ranks, [&](const SharedItem& item) {
    const auto at = std::ranges::lower_bound(outer, std::pair(item.id, std::uint32_t{0}));
    shared.set_sum(number(at->second), item.sum);
  });
}

RankFinest make_rank_finest(RoutedMesh&& given, int grid, float sigma0, Ranks& ranks, Scheduler& scheduler) {
  RoutedMesh routed = std::move(given);
  const Lattice lattice = routed.mesh.transform.lattice;
  Partition partition = partition_mesh(std::move(routed.mesh), grid, scheduler);
  RankFinest out;
  out.fingerprint = partition.fingerprint;
  out.part.codes = partition.codes;

  // Vertices of several ranks are shared, whatever the cells of this rank alone say.
  FinestVertices& vertices = partition.vertices;
  const std::vector<std::uint32_t>& vertex_ids = routed.vertex_ids.empty() ? routed.ids : routed.vertex_ids;
  OuterVertices outer;
  for (std::uint32_t v = 0; v < routed.ids.size(); ++v) {
    if (!routed.used_by_others[v]) continue;
    vertices.sharing[v] |= FinestVertices::shared_flag;
    outer.emplace_back(vertex_ids[v], v);
  }
  number_shared_vertices(vertices, scheduler);
  std::ranges::sort(outer);
  const auto join = [&](const FinestVertices& all, SharedVertices& shared) {
    join_shared(outer, all, routed.vertices, shared, ranks);
  };

  out.triangles = std::move(partition.triangles);
  out.part.cells = make_finest_cells(std::move(partition), grid, sigma0, scheduler, join);
  constexpr std::size_t cell_grain = 16;
  scheduler.for_chunks(out.part.cells.size(), cell_grain, [&](ChunkRange range) {
    for (std::size_t c = range.begin; c < range.end; ++c) {
      CellBuild& cell = out.part.cells[c];
      for (std::uint32_t& id : cell.vertex_ids) id = vertex_ids[id];
      for (std::uint32_t& id : cell.ids) id = routed.ids[id];
      for (std::uint32_t& id : cell.slab.shared_ids) id = routed.ids[id];
      cell.error = lattice.error();  // the lattice has moved the input
    }
  });
  return out;
}

}  // namespace lodestone
