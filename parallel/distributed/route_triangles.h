// From slices of the input to cells: every triangle goes to the rank that has its cell.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/hierarchy/construct/finest_cell.h"
#include "core/mesh/indexed_mesh.h"
#include "parallel/distributed/cell_owners.h"
#include "parallel/distributed/distributed_clean.h"
#include "parallel/distributed/messages/pieces.h"
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

// The two steps of it, for triangles and vertices that are kept elsewhere.
//
// Calls take(by rank) with the triangles of the own cells, by numbers of vertices: those of a rank come in its order.
using TakeTriangles = std::function<void(ByRank<Triangle>&&)>;
void exchange_triangles(const MeshStream& stream, const CleanSlices& clean, const FinestChoice& finest, Ranks& ranks,
                        const TakeTriangles& take);
// Asks for vertices by their numbers, and calls for all of them, in their order: first positions(some), then, when the
// slices are released, used_by_others(some), as in RoutedMesh. Memory: 13 bytes per vertex of the slice.
struct TakeVertices {
  std::function<void(std::span<const Vec3f>)> positions;
  std::function<void(std::span<const std::uint8_t>)> used_by_others;
};
void fetch_vertices(CleanSlices&& clean, std::span<const std::uint32_t> numbers, Ranks& ranks,
                    const TakeVertices& take);

}  // namespace lodestone
