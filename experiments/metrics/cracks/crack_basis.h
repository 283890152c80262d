// Data of a hierarchy (make_crack_basis) that the crack metrics compute beforehand: connectivity alone, so that a frame
// costs no more than the borders of the cells that it draws.
//
// The boundary of an oriented chain is linear. The drawn surface is the sum over the drawn cells of morphed M_l(C), so
// its boundary is the sum of the morphed boundaries of M_l(C): an edge that two triangles of one cell run through in
// opposite directions gives nothing wherever its ends are drawn. These boundaries do not depend on the frame. For
// cells of some thousand triangles they are a few per cent of all half-edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// A half-edge of one cell.
struct LocalEdge {
  VertexId from, to;
  friend bool operator==(const LocalEdge&, const LocalEdge&) = default;
};

// A leaf is a cell of level L, by its rank; those below any one cell are consecutive.
struct LeafRange {
  CellRank begin, end;
  [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

// About 2 bytes per stored triangle at thousands of triangles per cell; 24 for a soup of unconnected triangles.
struct CrackBasis {
  std::vector<LeafRange> leaves;  // one per cell of the hierarchy

  // The boundary of M_l(C) as a chain over local vertices, an edge of multiplicity m listed m times, by cell.
  std::vector<std::uint64_t> boundary_begin;
  std::vector<LocalEdge> boundary;

  // The unpaired half-edges of M_L, by leaf. Half-edges are paired off over vertex identity, first within a cell
  // (these never part), then across cells; where a non-manifold edge leaves a choice, those of the last cells remain.
  std::vector<std::uint64_t> unpaired_begin;
  std::vector<LocalEdge> unpaired;

  // Copies of the vertices of M_L that several leaves use, numbered by leaf and then in the order of its shared_ids;
  // copies[vertex_begin[i] .. vertex_begin[i + 1]) are the numbers of those of one vertex.
  std::vector<std::uint32_t> copy_begin;
  std::vector<std::uint32_t> vertex_begin;
  std::vector<std::uint32_t> copies;

  [[nodiscard]] std::span<const LocalEdge> boundary_of(CellId cell) const {
    return std::span(boundary).subspan(boundary_begin[cell], boundary_begin[cell + 1] - boundary_begin[cell]);
  }
  [[nodiscard]] std::span<const LocalEdge> unpaired_of(CellRank leaf) const {
    return std::span(unpaired).subspan(unpaired_begin[leaf], unpaired_begin[leaf + 1] - unpaired_begin[leaf]);
  }
};

// The ancestor at level `to`, in its cell, of a vertex of the cell, which is of level `from` >= to.
[[nodiscard]] inline VertexId follow_parents(const Hierarchy& hierarchy, CellId cell, VertexId vertex, int from,
                                             int to) {
  for (int level = from; level > to; --level) {
    const Cell& c = hierarchy.cells[cell];
    vertex = VertexId(c.parents[vertex]);
    cell = c.parent;
  }
  return vertex;
}

}  // namespace lodestone
