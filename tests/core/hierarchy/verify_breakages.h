// A small hierarchy is broken in every way that verify has a check for.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/core/hierarchy/lattice_meshes.h"

namespace lodestone::test {

// The whole one is naive_hierarchy(bumpy_sphere(4), finest, sigma0).
inline constexpr float sigma0 = 0.6f;
inline constexpr int finest = 2;

// Places in a NaiveHierarchy that the breakages below aim at.
inline CellId first_of(const NaiveHierarchy& t, int level) {
  return t.hierarchy.levels[static_cast<std::size_t>(level)].first_cell;
}
inline NaivePayload& finest_cell(NaiveHierarchy& t) { return (*t.payloads)[first_of(t, finest)]; }
inline NaivePayload& middle_cell(NaiveHierarchy& t) { return (*t.payloads)[first_of(t, 1)]; }
inline std::size_t first_shared(const NaivePayload& c) { return c.positions.size() - c.shared_ids.size(); }

inline Cell& most_moved_cell(NaiveHierarchy& t) {
  return *std::max_element(t.hierarchy.cells.begin(), t.hierarchy.cells.end(),
                           [](const Cell& a, const Cell& b) { return a.max_displacement < b.max_displacement; });
}

// A vertex of the cell that no other cell has and that has another parent to go to.
inline std::size_t own_vertex(const NaivePayload& cell) {
  EXPECT_GT(first_shared(cell), 0u);
  return 0;
}

struct Breakage {
  const char* check;  // the one that must fail
  const char* what;
  std::function<void(NaiveHierarchy&)> apply;
};

// Another parent than now, within the bound of (1) or not.
inline void send_elsewhere(NaiveHierarchy& t, CellId c, std::size_t v) {
  NaivePayload& cell = (*t.payloads)[c];
  const auto count = static_cast<std::uint32_t>((*t.payloads)[t.hierarchy.cells[c].parent].positions.size());
  cell.parents[v] = (cell.parents[v] + 1) % count;
}

inline const Breakage breakages[] = {
    {"structure", "level ranges", [](auto& t) { ++t.hierarchy.levels[1].first_cell; }},
    {"structure", "cells of no level", [](auto& t) { t.hierarchy.levels[finest].cell_count -= 1; }},
    {"structure", "Morton order",
     [](auto& t) { std::swap(t.hierarchy.cells[first_of(t, 1)].code, t.hierarchy.cells[first_of(t, 1) + 1].code); }},
    {"structure", "children", [](auto& t) { t.hierarchy.cells[0].child_count -= 1; }},
    {"structure", "parent", [](auto& t) { t.hierarchy.cells.back().parent = CellId(0); }},
    {"structure", "stored triangles", [](auto& t) { t.hierarchy.levels[1].triangles += 1; }},
    {"structure", "stored vertices", [](auto& t) { t.hierarchy.levels[1].vertices += 1; }},
    {"structure", "vertex index",
     [](auto& t) { finest_cell(t).triangles[0].v[0] = static_cast<std::uint32_t>(finest_cell(t).positions.size()); }},
    {"structure", "degenerate", [](auto& t) { finest_cell(t).triangles[0].v[0] = finest_cell(t).triangles[0].v[1]; }},
    {"structure", "parent index", [](auto& t) { finest_cell(t).parents[0] = 0xffff'ffffu; }},
    {"structure", "no parents", [](auto& t) { finest_cell(t).parents.pop_back(); }},
    {"structure", "no normals", [](auto& t) { finest_cell(t).normals.pop_back(); }},
    {"structure", "too many ids", [](auto& t) { finest_cell(t).shared_ids.resize(100'000); }},
    {"structure", "NaN", [](auto& t) { finest_cell(t).positions[0].x = std::nanf(""); }},
    {"structure", "no levels", [](auto& t) { t.hierarchy.levels.clear(); }},
    {"cells", "empty finest cell",
     [](auto& t) {
       t.hierarchy.levels[finest].triangles -= finest_cell(t).triangles.size();
       finest_cell(t).triangles.clear();
     }},
    {"partition", "triangle in the wrong cell",
     [](auto& t) { t.hierarchy.cells[first_of(t, finest)].code.morton ^= 1; }},
    {"partition", "vertex of no triangle",
     [](auto& t) {
       NaivePayload& cell = finest_cell(t);
       cell.positions.insert(cell.positions.begin(), Vec3f{0.1f, 0.1f, 0.1f});
       cell.normals.insert(cell.normals.begin(), PackedNormal{});
       cell.parents.insert(cell.parents.begin(), 0);
       for (Triangle& triangle : cell.triangles)
         for (std::uint32_t& v : triangle.v) ++v;
       t.hierarchy.levels[finest].vertices += 1;
     }},
    {"partition", "outside the root", [](auto& t) { finest_cell(t).positions[0].x = -0.001f; }},
    {"identity", "copies apart",
     [](auto& t) {
       Vec3f& p = finest_cell(t).positions.back();
       p.x = std::nextafter(p.x, 2.0f);
     }},
    {"identity", "minus zero is another pattern",
     [](auto& t) {
       for (std::size_t c = first_of(t, finest); c < t.payloads->size(); ++c)
         if ((*t.payloads)[c].shared_ids.back() == finest_cell(t).shared_ids.back())
           (*t.payloads)[c].positions.back().x = 0;
       finest_cell(t).positions.back().x = -0.0f;
     }},
    {"identity", "normals apart", [](auto& t) { finest_cell(t).normals.back().u ^= 1; }},
    {"identity", "shared by one cell", [](auto& t) { finest_cell(t).shared_ids.back() = 0xffff'fff0u; }},
    {"identity", "twice in one cell",
     [](auto& t) { finest_cell(t).shared_ids.back() = finest_cell(t).shared_ids.front(); }},
    {"identity", "not shared, though at one position",
     [](auto& t) {
       // The vertex comes first in its cell, so that it may be left out of the shared ones.
       NaivePayload& cell = finest_cell(t);
       cell.shared_ids.erase(cell.shared_ids.begin());
     }},
    {"identity", "id given to another vertex on the next level",
     [](auto& t) {
       // Two vertices that survive exchange their ids on level 1, in all copies.
       const NaivePayload& cell = middle_cell(t);
       ASSERT_GE(cell.shared_ids.size(), 2u);
       std::vector<std::uint32_t> kept;
       for (std::size_t c = first_of(t, finest); c < t.payloads->size(); ++c)
         for (const std::uint32_t id : (*t.payloads)[c].shared_ids)
           if (std::count(cell.shared_ids.begin(), cell.shared_ids.end(), id) > 0 && (kept.empty() || kept[0] != id))
             kept.push_back(id);
       ASSERT_GE(kept.size(), 2u);
       for (std::size_t c = first_of(t, 1); c < first_of(t, finest); ++c)
         for (std::uint32_t& id : (*t.payloads)[c].shared_ids)
           id = id == kept[0] ? kept[1] : id == kept[1] ? kept[0] : id;
     }},
    {"parents", "one copy goes elsewhere",
     [](auto& t) { send_elsewhere(t, first_of(t, finest), finest_cell(t).positions.size() - 1); }},
    {"parents", "on level 1 too",
     [](auto& t) { send_elsewhere(t, first_of(t, 1), middle_cell(t).positions.size() - 1); }},
    {"vertices", "vertex that is not a parent",
     [](auto& t) {
       NaivePayload& cell = (*t.payloads)[0];
       cell.positions.push_back(cell.positions[0]);
       cell.normals.push_back(cell.normals[0]);
       t.hierarchy.levels[0].vertices += 1;
     }},
    {"triangles", "own vertex goes elsewhere",
     [](auto& t) { send_elsewhere(t, first_of(t, finest), own_vertex(finest_cell(t))); }},
    {"triangles", "turned over",
     [](auto& t) { std::swap(middle_cell(t).triangles[0].v[0], middle_cell(t).triangles[0].v[1]); }},
    {"triangles", "one missing",
     [](auto& t) {
       middle_cell(t).triangles.pop_back();
       t.hierarchy.levels[1].triangles -= 1;
     }},
    {"triangles", "one twice",
     [](auto& t) {
       middle_cell(t).triangles.push_back(middle_cell(t).triangles[0]);
       t.hierarchy.levels[1].triangles += 1;
     }},
    {"displacement", "bound of (1)", [](auto& t) { t.hierarchy.sigma0 *= 0.4f; }},
    {"displacement", "stored too small",
     [](auto& t) {
       float& stored = most_moved_cell(t).max_displacement;
       stored = std::nextafter(stored, 0.0f);
     }},
    {"displacement", "stored too large", [](auto& t) { most_moved_cell(t).max_displacement *= 1.01f; }},
    {"displacement", "of the root", [](auto& t) { t.hierarchy.cells[0].max_displacement = 0.1f; }},
    {"edges", "longest too small", [](auto& t) { t.hierarchy.levels[1].max_edge *= 0.999f; }},
    {"edges", "longest too large", [](auto& t) { t.hierarchy.levels[1].max_edge *= 1.001f; }},
    {"edges", "long ones of the finest level", [](auto& t) { t.hierarchy.levels[finest].long_edges += 1; }},
    {"edges", "long ones of another level", [](auto& t) { t.hierarchy.levels[1].long_edges += 1; }},
    {"boxes", "too large",
     [](auto& t) { t.hierarchy.cells[1].bounds.hi.x = std::nextafter(t.hierarchy.cells[1].bounds.hi.x, 2.0f); }},
    {"boxes", "too small",
     [](auto& t) {
       t.hierarchy.cells.back().bounds.lo.y = std::nextafter(t.hierarchy.cells.back().bounds.lo.y, 2.0f);
     }},
    {"boxes", "without the children's",
     [](auto& t) {
       t.hierarchy.cells[0].bounds = {};
       for (const Vec3f p : (*t.payloads)[0].positions) t.hierarchy.cells[0].bounds.extend(p);
     }},
    {"reach", "Euclidean too small", [](auto& t) { t.hierarchy.levels[1].reach[0] *= 0.999f; }},
    {"reach", "Euclidean too large", [](auto& t) { t.hierarchy.levels[1].reach[0] *= 1.001f; }},
    {"reach", "Chebyshev too small", [](auto& t) { t.hierarchy.levels[finest].reach[1] *= 0.999f; }},
    {"reach", "diameter too small", [](auto& t) { t.hierarchy.levels[0].diameter *= 0.999f; }},
    {"errors", "not 0 on the finest level", [](auto& t) { t.hierarchy.cells.back().error = 1e-6f; }},
    {"errors", "less than the children's",
     [](auto& t) { t.hierarchy.cells[0].error = std::nextafter(t.hierarchy.cells[1].error, 0.0f); }},
    {"errors", "less than the distance of the children's vertices",
     [](auto& t) { t.hierarchy.cells[0].error = t.hierarchy.cells[1].error; }},
    {"errors", "absurdly large", [](auto& t) { t.hierarchy.cells[1].error *= 2; }},
    {"errors", "of the level", [](auto& t) { t.hierarchy.levels[1].error *= 0.99f; }},
    {"fingerprint", "triangle turned over",
     [](auto& t) { std::swap(finest_cell(t).triangles[0].v[0], finest_cell(t).triangles[0].v[1]); }},
    {"fingerprint", "fewer triangles", [](auto& t) { t.hierarchy.provenance.input_triangles -= 1; }},
    {"fingerprint", "fewer vertices", [](auto& t) { t.hierarchy.provenance.input_vertices -= 1; }},
    {"fingerprint", "another input", [](auto& t) { t.hierarchy.provenance.fingerprint += 1; }},
    {"input", "turned over",
     [](auto& t) { std::swap(finest_cell(t).triangles[0].v[0], finest_cell(t).triangles[0].v[1]); }},
    {"input", "moved by one place",
     [](auto& t) {
       float& x = finest_cell(t).positions[0].x;
       x = std::nextafter(x, 2.0f);
     }},
    {"input", "one twice, one missing", [](auto& t) { finest_cell(t).triangles[0] = finest_cell(t).triangles[1]; }},
    {"input", "another scale", [](auto& t) { t.hierarchy.transform.scale *= 2; }},
};

}  // namespace lodestone::test
