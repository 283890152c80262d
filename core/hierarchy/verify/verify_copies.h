// Internals of verify: the copies that cells have of one vertex, and P of all of them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/verify/verify_checks.h"
#include "core/hierarchy/verify/verify_part.h"

namespace lodestone::verify {

// A copy of a vertex with a shared id, with all that the checks compare.
struct VertexCopy {
  std::uint32_t id = 0;
  CellId cell;
  VertexId local;
  Vec3f position;
  PackedNormal normal;
  // Its parent: by the shared id, or else, of no other cell, by its number in the parent cell. At the root none.
  std::uint32_t parent = 0;
  CellId parent_cell;  // no_cell: `parent` is an id
  [[nodiscard]] bool same_parent(const VertexCopy& other) const {
    return parent == other.parent && parent_cell == other.parent_cell;
  }
};

// All copies of a level of the vertices that meet here, by id, then by cell, then by number. Called by all peers.
[[nodiscard]] std::vector<VertexCopy> copies_of(const Part& part, int level);

// Calls body(first, last) for each run of copies of one vertex.
template <typename Body>
void for_runs(const std::vector<VertexCopy>& copies, Body&& body) {
  for (auto first = copies.begin(); first != copies.end();) {
    auto last = first + 1;
    while (last != copies.end() && last->id == first->id) ++last;
    body(first, last);
    first = last;
  }
}

void check_copies(const Part& part, int level, const std::vector<VertexCopy>& copies, Finding& identity);
// One identity has one position (check_copies), so it is enough that different identities have different positions.
void check_positions_distinct(const Part& part, const std::vector<VertexCopy>& finest, Finding& identity);
void check_ids_kept(const std::vector<VertexCopy>& fine, const std::vector<VertexCopy>& coarse, Finding& identity);
void check_parent_function(int level, const std::vector<VertexCopy>& fine, Finding& parents);

// The vertices of a level that meet here, and those here that no other cell has: each vertex once, over all peers.
[[nodiscard]] std::uint64_t count_vertices(const Part& part, int level, const std::vector<VertexCopy>& copies);

}  // namespace lodestone::verify
