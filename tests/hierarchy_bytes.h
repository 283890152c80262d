// Everything that a hierarchy of vertices without attributes holds, in order, except its transform.
#pragma once

#include <array>
#include <string>

#include "core/hierarchy/model/hierarchy.h"
#include "tests/test_bytes.h"

namespace lodestone::test {

inline std::string hierarchy_bytes(const Hierarchy& h) {
  std::string out;
  for (const Level& l : h.levels) {  // value by value: the bytes between them are never set
    append_bytes(out, std::array<std::uint32_t, 2>{l.first_cell, l.cell_count});
    append_bytes(out, std::array<std::uint64_t, 3>{l.triangles, l.vertices, l.long_edges});
    append_bytes(out, l.reach);
    append_bytes(out, std::array<float, 3>{l.diameter, l.error, l.max_edge});
  }
  for (const Cell& c : h.cells) {
    append_bytes(out, std::span<const std::uint64_t>(&c.code.morton, 1));
    append_bytes(out, std::array<std::uint32_t, 3>{c.parent, c.first_child, c.child_count});
    append_bytes(out, std::span<const Box3f>(&c.bounds, 1));
    append_bytes(out, std::array<float, 2>{c.max_displacement, c.error});
    append_bytes(out, c.positions);
    append_bytes(out, c.normals);
    append_bytes(out, c.parents);
    append_bytes(out, c.shared_ids);
    append_bytes(out, c.triangles);
    append_bytes(out, c.border_errors);
  }
  return out;
}

}  // namespace lodestone::test
