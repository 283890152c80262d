// Internals of verify: which stored vertices of a hierarchy with attributes are wedges of one vertex. The wedges of one
// vertex are not stored: on the finest level they follow from their positions; on coarser ones wedges belong to one
// vertex when P maps wedges of one finer vertex to them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/verify/verify_copies.h"

namespace lodestone::verify {

// By stored vertex of a level, cell by cell.
struct LevelWedges {
  CellId first_cell;
  std::vector<std::uint32_t> first_vertex;  // one per cell of the level and one more
  std::vector<std::uint32_t> identity;      // the first copy
  std::vector<std::uint32_t> vertex;        // the first wedge of the same vertex

  [[nodiscard]] std::uint32_t number(CellId cell, std::uint32_t local) const {
    return first_vertex[cell - first_cell] + local;
  }
};

// Wedges of the finest level are one vertex if they have one position.
[[nodiscard]] LevelWedges finest_wedges(const Hierarchy& hierarchy, const std::vector<VertexCopy>& copies);
// Those of the level above `level`, which has `fine`. Also requires that wedges of one vertex have parents at one
// position.
[[nodiscard]] LevelWedges coarser_wedges(const Hierarchy& hierarchy, int level, const LevelWedges& fine,
                                         const std::vector<VertexCopy>& copies_above, Finding& wedges);

}  // namespace lodestone::verify
