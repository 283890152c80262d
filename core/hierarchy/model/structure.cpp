#include "core/hierarchy/model/structure.h"

#include <cmath>

namespace lodestone {
namespace {

bool is_bound(float v) { return std::isfinite(v) && v >= 0; }

const char* header_fault(const Hierarchy& h) {
  if (!is_finite(h.transform.origin) || !std::isfinite(h.transform.scale) || !(h.transform.scale > 0))
    return "origin or scale is not finite";
  if (h.transform.lattice.bits < 0 || h.transform.lattice.bits > Lattice::most_bits)
    return "the lattice is out of range";
  if (!std::isfinite(h.sigma0) || !(h.sigma0 > 0)) return "sigma0 is not a positive number";
  if (h.levels.empty() || h.levels.size() > max_level + 1) return "the number of levels is out of range";
  return nullptr;
}

// The levels cut the cell table into consecutive runs; the root level is the one root cell.
const char* level_fault(const Hierarchy& h) {
  std::uint64_t next_cell = 0;
  for (const Level& level : h.levels) {
    if (level.first_cell != next_cell || level.cell_count == 0) return "the levels are not consecutive";
    next_cell += level.cell_count;
    if (next_cell > h.cells.size()) return "a level goes beyond the last cell";
    if (!is_bound(level.reach[0]) || !is_bound(level.reach[1]) || !is_bound(level.diameter) || !is_bound(level.error) ||
        !is_bound(level.max_edge))
      return "a bound of a level is negative or not finite";
  }
  if (next_cell != h.cells.size()) return "cells belong to no level";
  if (h.levels.front().cell_count != 1) return "the root level has more than one cell";
  if (h.cells.front().parent != no_cell) return "the root has a parent";
  return nullptr;
}

const char* cell_fault(const Hierarchy& h, int l, CellId c) {
  const Cell& cell = h.cells[c];
  if (cell.code.morton >> (3 * h.grids.of(l)) != 0) return "lies outside the grid";
  if (c > h.levels[static_cast<std::size_t>(l)].first_cell && !(h.cells[c - 1].code < cell.code))
    return "is not in Morton order";
  if (!is_finite(cell.bounds.lo) || !is_finite(cell.bounds.hi) || cell.bounds.empty()) return "has no finite box";
  if (!is_bound(cell.max_displacement) || !is_bound(cell.error)) return "has a bound that is negative or not finite";
  return nullptr;
}

// The children of a level's cells, one after the other, are the next level.
const char* children_fault(const Hierarchy& h, int l, CellId c, std::uint64_t& next_child) {
  const Cell& cell = h.cells[c];
  if (l == h.finest()) return cell.child_count == 0 ? nullptr : "is on the finest level and has children";
  if (cell.child_count == 0 || cell.child_count > 8 || cell.first_child != next_child ||
      next_child + cell.child_count > h.cells.size())
    return "has children out of range";
  for (CellId k = cell.first_child; k < cell.end_child(); ++k)
    if (h.cells[k].parent != c || h.grids.parent(h.cells[k].code, l + 1) != cell.code)
      return "has a child of another parent";
  next_child += cell.child_count;
  return nullptr;
}

bool counts_fit(const Hierarchy& h, int l) {
  std::uint64_t triangles = 0, vertices = 0;
  for (const Cell& cell : h.cells_of(l)) {
    triangles += cell.triangles.size();
    vertices += cell.positions.size();
  }
  const Level& level = h.levels[static_cast<std::size_t>(l)];
  return level.triangles == triangles && level.vertices == vertices;
}

}  // namespace

std::string table_fault(const Hierarchy& h) {
  if (const char* fault = header_fault(h)) return fault;
  if (const char* fault = level_fault(h)) return fault;
  for (int l = 0; l <= h.finest(); ++l) {
    const Level& level = h.levels[static_cast<std::size_t>(l)];
    const std::uint32_t end = level.end_cell();
    std::uint64_t next_child = end;
    for (CellId c = level.first_cell; c < end; ++c) {
      const char* fault = cell_fault(h, l, c);
      if (!fault) fault = children_fault(h, l, c, next_child);
      if (fault) return "cell " + std::to_string(c) + " " + fault;
    }
    if (l < h.finest()) {
      const Level& finer = h.levels[static_cast<std::size_t>(l) + 1];
      if (next_child != std::uint64_t{finer.first_cell} + finer.cell_count)
        return "a cell of level " + std::to_string(l + 1) + " has no parent";
    }
    if (!counts_fit(h, l)) return "the counts of level " + std::to_string(l) + " do not match its cells";
  }
  return {};
}

const char* payload_fault(const Hierarchy& h, CellId c) {
  const Cell& cell = h.cells[c];
  return payload_fault(cell, h.attributes, cell.parent == no_cell ? 0 : h.cells[cell.parent].positions.size());
}

const char* payload_fault(const Cell& cell, AttributeSet attributes, std::size_t parent_vertices) {
  const bool root = cell.parent == no_cell;
  if (cell.normals.size() != cell.positions.size()) return "the number of normals is not that of the vertices";
  if (cell.parents.size() != (root ? 0 : cell.positions.size()))
    return "the number of parents is not that of the vertices";
  const auto fits = [&](const auto& values, bool there) {
    return values.size() == (there ? cell.positions.size() : 0);
  };
  if (!fits(cell.attributes.uv, attributes.uv) || !fits(cell.attributes.colours, attributes.colours) ||
      !fits(cell.attributes.materials, attributes.materials))
    return "the number of values of an attribute is not that of the vertices";
  if (cell.shared_ids.size() > cell.positions.size()) return "there are more shared vertices than vertices";
  for (const Vec3f p : cell.positions)
    if (!is_finite(p)) return "a position is not finite";
  for (const std::uint32_t parent : cell.parents)
    if (parent >= parent_vertices) return "a parent is out of range";
  for (const Triangle& t : cell.triangles) {
    for (const std::uint32_t v : t.v)
      if (v >= cell.positions.size()) return "a vertex of a triangle is out of range";
    if (is_degenerate(t)) return "a triangle is degenerate";
  }
  return nullptr;
}

}  // namespace lodestone
