// Internals of verify: which stored vertices of a hierarchy with attributes are wedges of one vertex. The wedges of one
// vertex are not stored: on the finest level they follow from their positions; on coarser ones wedges belong to one
// vertex when P maps wedges of one finer vertex to them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/hierarchy/verify/verify_checks.h"
#include "core/hierarchy/verify/verify_part.h"

namespace lodestone::verify {

// The vertices of a level by its stored ones, for the cells that are here or have children here.
class LevelWedges {
 public:
  LevelWedges(const Part& part, int level);

  [[nodiscard]] bool has(CellId cell) const { return place_[cell - first_cell_] != nowhere; }
  [[nodiscard]] std::size_t size() const { return vertex_.size(); }
  // Stored vertices are numbered through the level, cell by cell.
  [[nodiscard]] std::uint32_t number(CellId cell, std::uint32_t local) const {
    return number_[cell - first_cell_] + local;
  }
  // A number that all wedges of a vertex and all their copies have in common.
  [[nodiscard]] std::uint32_t vertex(CellId cell, std::uint32_t local) const {
    return vertex_[place_[cell - first_cell_] + local];
  }
  void set_vertex(CellId cell, std::uint32_t local, std::uint32_t name) {
    vertex_[place_[cell - first_cell_] + local] = name;
  }

 private:
  static constexpr std::uint32_t nowhere = 0xffff'ffffu;
  CellId first_cell_;
  std::vector<std::uint32_t> number_;  // by cell: that of its first vertex
  std::vector<std::uint32_t> place_;   // by cell: of its first vertex in vertex_
  std::vector<std::uint32_t> vertex_;
};

// Wedges of the finest level are one vertex if they have one position. Called by all peers, as the one below.
[[nodiscard]] LevelWedges finest_wedges(const Part& part);
// Those of the level above `level`, which has `fine`. Also requires that wedges of one vertex have parents at one
// position.
[[nodiscard]] LevelWedges coarser_wedges(const Part& part, int level, const LevelWedges& fine, Finding& wedges);

}  // namespace lodestone::verify
