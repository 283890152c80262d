// Checks of the finest level by itself: its cells, its partition, its fingerprint.
#include "core/hierarchy/model/fingerprint.h"
#include "core/hierarchy/verify/verify_checks.h"

namespace lodestone::verify {

// Every coarse cell has children (check_structure), so that the finest cells are enough.
void check_cells(const Part& part, Finding& cells) {
  if (!part.has_tables()) return;
  const Hierarchy& hierarchy = part.hierarchy;
  const Level& finest = hierarchy.levels.back();
  for (CellId c = finest.first_cell; c < finest.end_cell(); ++c)
    cells.require(!hierarchy.cells[c].triangles.empty(),
                  [&] { return place(hierarchy.finest(), c) + ": exists without a triangle of the finest level"; });
}

void check_partition(const Part& part, Finding& partition) {
  const int l = part.hierarchy.finest();
  std::vector<char> used;
  part.for_cells(l, [&](CellId c) {
    const Cell& cell = part.hierarchy.cells[c];
    used.assign(cell.positions.size(), 0);
    for (const Triangle& t : cell.triangles) {
      for (const std::uint32_t v : t.v) used[v] = 1;
      const Vec3f centre = barycentre(cell.positions[t.v[0]], cell.positions[t.v[1]], cell.positions[t.v[2]]);
      partition.require(CellCode::from(cell_of(centre, part.hierarchy.grids.of(l))) == cell.code,
                        [&] { return place(l, c) + ": a triangle has its barycentre in another cell"; });
    }
    for (VertexId v{0}; v < cell.positions.size(); ++v) {
      const Vec3f p = cell.positions[v];
      partition.require(used[v] != 0, [&] { return place(l, c, v) + ": no triangle uses it"; });
      partition.require(Box3f{{0, 0, 0}, {1, 1, 1}}.contains(p),
                        [&] { return place(l, c, v) + ": outside the root cell"; });
    }
  });
}

void check_fingerprint(const Part& part, std::uint64_t vertices, Finding& fingerprint) {
  const Provenance& input = part.hierarchy.provenance;
  const std::uint64_t triangles = part.hierarchy.levels.back().triangles;
  std::uint64_t sum = 0;
  part.for_cells(part.hierarchy.finest(), [&](CellId c) {
    const Cell& cell = part.hierarchy.cells[c];
    for (const Triangle& t : cell.triangles)
      sum += triangle_fingerprint(cell.positions[t.v[0]], cell.positions[t.v[1]], cell.positions[t.v[2]]);
  });
  sum = part.sum(sum);
  if (!part.has_tables()) return;
  fingerprint.require(triangles == input.input_triangles, [&] {
    return std::to_string(triangles) + " triangles on the finest level, " + std::to_string(input.input_triangles) +
           " in the input";
  });
  fingerprint.require(vertices == input.input_vertices, [&] {
    return std::to_string(vertices) + " vertices on the finest level, " + std::to_string(input.input_vertices) +
           " in the input";
  });
  fingerprint.require(sum == input.fingerprint, [] { return "the triangles of the finest level are not the input's"; });
}

}  // namespace lodestone::verify
