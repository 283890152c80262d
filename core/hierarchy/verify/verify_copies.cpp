// Copies of a vertex meet at the peer of its id, those of a position at the peer of its hash.
#include "core/hierarchy/verify/verify_copies.h"

#include <cstring>
#include <string>
#include <tuple>

namespace lodestone::verify {
namespace {

bool same_bits(Vec3f a, Vec3f b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

// The first copy of a vertex.
struct Place {
  float x, y, z;
  CellId cell;
  VertexId local;
  [[nodiscard]] auto key() const { return std::tie(x, y, z); }  // -0 == +0
};

}  // namespace

std::vector<VertexCopy> copies_of(const Part& part, int level) {
  std::vector<VertexCopy> copies;
  part.for_cells(level, [&](CellId c) {
    const Cell& cell = part.hierarchy.cells[c];
    for (VertexId v{cell.first_shared()}; v < cell.positions.size(); ++v) {
      VertexCopy& copy = copies.emplace_back();
      copy.id = cell.shared_ids[v - cell.first_shared()];
      copy.cell = c, copy.local = v;
      copy.position = cell.positions[v], copy.normal = cell.normals[v];
      if (level == 0) continue;
      const Cell& above = part.hierarchy.cells[cell.parent];
      copy.parent = cell.parents[v];
      copy.parent_cell = cell.parent;
      if (copy.parent < above.first_shared()) continue;
      copy.parent = above.shared_ids[copy.parent - above.first_shared()];
      copy.parent_cell = no_cell;
    }
  });
  copies = part.sort_out(std::move(copies), [](const VertexCopy& copy) { return copy.id; });
  std::sort(copies.begin(), copies.end(), [](const VertexCopy& a, const VertexCopy& b) {
    return std::tie(a.id, a.cell, a.local) < std::tie(b.id, b.cell, b.local);
  });
  return copies;
}

void check_copies(const Part& part, int level, const std::vector<VertexCopy>& copies, Finding& identity) {
  for_runs(copies, [&](auto first, auto last) {
    const auto where = [&] { return place(level, first->cell, first->local) + ", id " + std::to_string(first->id); };
    // A wedge may be shared because another wedge of its vertex is.
    identity.require(last - first >= 2 || part.hierarchy.attributes.wedges,
                     [&] { return where() + ": shared, but in one cell only"; });
    for (auto copy = first + 1; copy < last; ++copy) {
      identity.require(copy->cell != (copy - 1)->cell, [&] { return where() + ": twice in one cell"; });
      identity.require(same_bits(first->position, copy->position),
                       [&] { return where() + ": copies at different positions"; });
      identity.require(first->normal == copy->normal, [&] { return where() + ": copies with different normals"; });
    }
  });
}

void check_positions_distinct(const Part& part, const std::vector<VertexCopy>& finest, Finding& identity) {
  std::vector<Place> places;
  for_runs(finest, [&](auto first, auto) {
    places.push_back({first->position.x, first->position.y, first->position.z, first->cell, first->local});
  });
  part.for_cells(part.hierarchy.finest(), [&](CellId c) {
    const Cell& cell = part.hierarchy.cells[c];
    for (VertexId v{0}; v < cell.first_shared(); ++v)
      places.push_back({cell.positions[v].x, cell.positions[v].y, cell.positions[v].z, c, v});
  });
  places = part.sort_out(std::move(places), [](const Place& p) { return key_of(Vec3f{p.x, p.y, p.z}); });
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::tie(a.x, a.y, a.z, a.cell, a.local) < std::tie(b.x, b.y, b.z, b.cell, b.local);
  });
  for (std::size_t i = 0; i < places.size(); ++i)
    identity.require(i == 0 || places[i - 1].key() != places[i].key(), [&] {
      return "cells " + std::to_string(places[i - 1].cell) + " and " + std::to_string(places[i].cell) +
             ": two vertices of the finest level at one position";
    });
}

void check_ids_kept(const std::vector<VertexCopy>& fine, const std::vector<VertexCopy>& coarse, Finding& identity) {
  auto above = coarse.begin();
  for_runs(fine, [&](auto first, auto) {
    while (above != coarse.end() && above->id < first->id) ++above;
    if (above == coarse.end() || above->id != first->id) return;
    identity.require(first->parent_cell == no_cell && first->parent == first->id, [&] {
      return "id " + std::to_string(first->id) + " of cell " + std::to_string(first->cell) + " and of cell " +
             std::to_string(above->cell) + ": not the same vertex under P";
    });
  });
}

void check_parent_function(int level, const std::vector<VertexCopy>& fine, Finding& parents) {
  for_runs(fine, [&](auto first, auto last) {
    for (auto copy = first + 1; copy < last; ++copy)
      parents.require(copy->same_parent(*first), [&] {
        return place(level, copy->cell, copy->local) + ", id " + std::to_string(copy->id) +
               ": another parent than in cell " + std::to_string(first->cell);
      });
  });
}

std::uint64_t count_vertices(const Part& part, int level, const std::vector<VertexCopy>& copies) {
  std::uint64_t count = 0;
  for_runs(copies, [&](auto, auto) { ++count; });
  part.for_cells(level, [&](CellId c) { count += part.hierarchy.cells[c].first_shared(); });
  return part.sum(count);
}

}  // namespace lodestone::verify
