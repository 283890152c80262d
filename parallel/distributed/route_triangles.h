// From slices of the input to cells: every triangle goes to the rank that has its cell.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/construct/finest_cell.h"
#include "core/mesh/indexed_mesh.h"
#include "parallel/distributed/cell_owners.h"
#include "parallel/distributed/distributed_clean.h"
#include "parallel/hierarchy/build.h"

namespace lodestone {

struct FinestChoice {
  int level = 0, grid = 0;  // its cells lie in the grid
  CellOwners owners;
};

// Chooses the finest level as choose_finest_level does, or takes that of the configuration, and deals out the cells by
// the same sample of the triangles. Memory: a mebibyte.
[[nodiscard]] FinestChoice choose_cells(const MeshStream& stream, const CleanSlices& clean, const BuildConfig& config,
                                        Ranks& ranks);

// The triangles of the cells of a rank, in input order, and the vertices that they use.
struct RoutedMesh {
  IndexedMesh mesh;
  std::vector<std::uint32_t> ids;            // by vertex of the mesh: its number in the whole clean mesh
  std::vector<std::uint8_t> used_by_others;  // by vertex of the mesh: 1 if triangles of other ranks use it, too
  Slices vertices;                           // by id: whose word it is whether others use a vertex
  // With wedges, which are the vertices of the mesh then: the id of the vertex of each, in `vertices`, and
  // used_by_others counts for the first one of each vertex. Empty otherwise: the same as ids.
  std::vector<std::uint32_t> vertex_ids{};
};

// Consumes the slices. Memory at the peak: 24 bytes per triangle, and about 30 per vertex, of the rank's cells, beside
// the slices, of which the vertices are released last.
[[nodiscard]] RoutedMesh route_triangles(const MeshStream& stream, CleanSlices&& clean, const FinestChoice& finest,
                                         Ranks& ranks);

}  // namespace lodestone
