// The cells of the finest level that a rank has.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/hierarchy/construct/cell_build.h"
#include "parallel/distributed/messages/ranks.h"
#include "parallel/distributed/route_triangles.h"
#include "parallel/hierarchy/shared_vertices.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Some cells of a level, by code.
struct CellPart {
  std::vector<CellCode> codes;  // ascending
  std::vector<CellBuild> cells;
};

struct RankFinest {
  CellPart part;
  std::vector<Triangle> triangles;  // that the cells look at
  std::uint64_t fingerprint = 0;    // of the rank's triangles
};

// As make_finest_cells for all ranks together, of the cells of a grid: what cells of several ranks know of a vertex
// that they share is added up at the rank of its id. With wedges the ids of their vertices are those of all ranks.
// Consumes the mesh. Memory: as partition_mesh, and 40 bytes per
// vertex shared between ranks.
[[nodiscard]] RankFinest make_rank_finest(RoutedMesh&& routed, int grid, float sigma0, Ranks& ranks,
                                          Scheduler& scheduler);

// The vertices of a rank that other ranks use, too: number in the whole mesh and among the rank's own, ascending.
using OuterVertices = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Called by all ranks when all of their cells are added to the shared vertices: gives those of several ranks what all
// of these know of them. `slices`: of the numbers.
void join_shared(const OuterVertices& outer, const FinestVertices& all, const Slices& slices, SharedVertices& shared,
                 Ranks& ranks);

}  // namespace lodestone
