// Reordering a cell changes nothing but the order.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "core/hierarchy/construct/cell_order.h"
#include "core/mesh/clean.h"
#include "tests/core/hierarchy/lattice_meshes.h"

namespace lodestone {
namespace {

CellBuild build_of(const Cell& cell) {
  CellBuild build;
  build.slab.allocate(cell.positions.size(), cell.shared_ids.size(), cell.triangles.size());
  std::ranges::copy(cell.positions, build.slab.positions.begin());
  std::ranges::copy(cell.normals, build.slab.normals.begin());
  std::ranges::copy(cell.parents, build.slab.parents.begin());
  std::ranges::copy(cell.shared_ids, build.slab.shared_ids.begin());
  std::ranges::copy(cell.triangles, build.slab.triangles.begin());
  build.triangles = build.slab.triangles;
  return build;
}

std::vector<std::array<std::uint32_t, 3>> sorted(const Triangles& triangles,
                                                 const std::vector<std::uint32_t>* moved = nullptr) {
  std::vector<std::array<std::uint32_t, 3>> result;
  for (Triangle t : triangles) {
    if (moved)
      for (std::uint32_t& v : t.v) v = (*moved)[v];
    result.push_back(canonical(t).v);
  }
  std::ranges::sort(result);
  return result;
}

TEST(CellOrder, KeepsVerticesTrianglesAndParents) {
  const Hierarchy h = test::naive_hierarchy(test::bumpy_sphere(4), 2, 0.3f).hierarchy;
  CellOrderScratch scratch;
  std::vector<CellBuild> builds;
  std::vector<std::vector<std::uint32_t>> moved;
  for (const Cell& cell : h.cells) {
    builds.push_back(build_of(cell));
    moved.push_back(order_cell(builds.back(), scratch));
  }
  for (std::size_t c = 0; c < h.cells.size(); ++c) {
    const Cell& cell = h.cells[c];
    CellBuild& build = builds[c];
    std::vector<std::uint32_t> places = moved[c];
    std::ranges::sort(places);
    for (std::uint32_t v = 0; v < places.size(); ++v) ASSERT_EQ(places[v], v);
    for (std::uint32_t v = 0; v < cell.positions.size(); ++v) {
      EXPECT_EQ(build.slab.positions[moved[c][v]], cell.positions[v]);
      EXPECT_EQ(build.slab.normals[moved[c][v]], cell.normals[v]);
      EXPECT_EQ(moved[c][v] >= cell.first_shared(), v >= cell.first_shared());
      if (v < cell.first_shared()) continue;
      EXPECT_EQ(build.slab.shared_ids[moved[c][v] - cell.first_shared()], cell.shared_ids[v - cell.first_shared()]);
    }
    EXPECT_EQ(sorted(build.triangles), sorted(cell.triangles, &moved[c]));
    if (cell.parent == no_cell) continue;
    order_parents(build, moved[c], moved[cell.parent], scratch);
    for (std::uint32_t v = 0; v < cell.positions.size(); ++v)
      EXPECT_EQ(build.slab.parents[moved[c][v]], moved[cell.parent][cell.parents[v]]);
  }
}

TEST(CellOrder, NumbersOwnVerticesByFirstUse) {
  const Hierarchy h = test::naive_hierarchy(test::bumpy_sphere(4), 1, 0.3f).hierarchy;
  CellOrderScratch scratch;
  for (const Cell& cell : h.cells) {
    CellBuild build = build_of(cell);
    (void)order_cell(build, scratch);
    std::uint32_t next = 0;
    for (const Triangle& t : build.triangles)
      for (const std::uint32_t v : t.v)
        if (v < cell.first_shared()) {
          EXPECT_LE(v, next);
          next = std::max(next, v + 1);
        }
  }
}

TEST(CellOrder, MovesAttributesAndKeepsMaterialsTogether) {
  const Hierarchy h = test::naive_hierarchy(test::bumpy_sphere(4), 0, 0.3f).hierarchy;
  const Cell& cell = h.cells[0];
  CellBuild build;
  build.slab.allocate(cell.positions.size(), 0, cell.triangles.size(),
                      {.wedges = true, .uv = true, .colours = true, .materials = true});
  std::ranges::copy(cell.positions, build.slab.positions.begin());
  std::ranges::copy(cell.normals, build.slab.normals.begin());
  // Material by the vertex's number; a cell has each triangle in one material only, so others are left out.
  const auto material_of = [&](std::uint32_t v) { return cell.positions[v].x < 0.5f ? 3u : 7u; };
  for (std::uint32_t v = 0; v < cell.positions.size(); ++v) {
    build.slab.uv[v] = {static_cast<float>(v), 0};
    build.slab.colours[v].r = static_cast<std::uint8_t>(v);
    build.slab.materials[v] = material_of(v);
  }
  std::vector<Triangle> triangles;
  for (const std::uint32_t material : {3u, 7u})
    for (const Triangle& t : cell.triangles)
      if (std::ranges::all_of(t.v, [&](std::uint32_t v) { return material_of(v) == material; })) triangles.push_back(t);
  std::ranges::copy(triangles, build.slab.triangles.begin());
  build.triangles = build.slab.triangles.first(triangles.size());
  CellOrderScratch scratch;
  const std::vector<std::uint32_t> moved = order_cell(build, scratch);
  for (std::uint32_t v = 0; v < cell.positions.size(); ++v) {
    EXPECT_EQ(build.slab.uv[moved[v]].x, static_cast<float>(v));
    EXPECT_EQ(build.slab.colours[moved[v]].r, static_cast<std::uint8_t>(v));
    EXPECT_EQ(build.slab.materials[moved[v]], material_of(v));
  }
  EXPECT_TRUE(
      std::ranges::is_sorted(build.triangles, {}, [&](const Triangle& t) { return build.slab.materials[t.v[0]]; }));
  EXPECT_EQ(sorted(build.triangles), sorted(triangles, &moved));
}

TEST(CellOrder, TakesCellsWithoutTriangles) {
  CellBuild build;
  build.slab.allocate(2, 1, 0);
  build.slab.positions[0] = {1, 0, 0};
  build.slab.positions[1] = {0, 1, 0};
  build.slab.shared_ids[0] = 7;
  CellOrderScratch scratch;
  EXPECT_EQ(order_cell(build, scratch), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(build.slab.shared_ids[0], 7u);
}

}  // namespace
}  // namespace lodestone
