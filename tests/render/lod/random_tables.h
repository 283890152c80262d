// Tables of random hierarchies, and views that need some of their families: for tests of streaming.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <random>
#include <vector>

#include "render/lod/family_choice.h"

namespace lodestone::testing {

inline float uniform(std::mt19937& random, float lo, float hi) {
  return std::uniform_real_distribution(lo, hi)(random);
}
inline Vec3f random_point(std::mt19937& random) {
  return {uniform(random, -0.2f, 1.2f), uniform(random, -0.2f, 1.2f), uniform(random, -0.2f, 1.2f)};
}

inline Box3f random_box_in(const Box3f& box, std::mt19937& random) {
  Box3f inner;
  for (float Vec3f::*axis : {&Vec3f::x, &Vec3f::y, &Vec3f::z}) {
    const float lo = uniform(random, box.lo.*axis, box.hi.*axis);
    inner.lo.*axis = lo;
    inner.hi.*axis = std::min(lo + uniform(random, 0.3f, 0.7f) * (box.hi.*axis - box.lo.*axis), box.hi.*axis);
  }
  return inner;
}

// Tables of a hierarchy without surface: random boxes, radii (that is, errors) and sizes of families.
struct Tables {
  Tables() = default;
  explicit Tables(std::mt19937& random) {
    hierarchy.levels.resize(3 + random() % 4);
    hierarchy.cells.resize(1);
    hierarchy.cells[0].bounds = {{0, 0, 0}, {1, 1, 1}};
    hierarchy.levels[0].cell_count = 1;
    for (std::size_t l = 1; l < hierarchy.levels.size(); ++l)
      add_level(l, [&](CellId parent) {
        std::vector<Box3f> boxes(2 + random() % 5);
        for (Box3f& box : boxes) box = random_box_in(hierarchy.cells[parent].bounds, random);
        return boxes;
      });
    radii.metric = random() % 2 ? DistanceMetric::euclidean : DistanceMetric::chebyshev;
    float radius = uniform(random, 0.8f, 2.5f);
    const float begin = random() % 2 ? 0.3f : 0;  // where bands are as wide as their radius, they begin at 0
    for (std::size_t l = 0; l < hierarchy.levels.size(); ++l, radius *= uniform(random, 0.3f, 0.8f))
      radii.select.push_back(radius), radii.band_begin.push_back(begin * radius);
    bytes.resize(hierarchy.cells.size());
    for (CellId c{0}; c < bytes.size(); ++c)
      if (hierarchy.cells[c].child_count > 0) bytes[c] = 16u << random() % 5;
  }

  // `children_of(parent)` returns the boxes of a cell's children.
  void add_level(std::size_t level, const auto& children_of) {
    const Level above = hierarchy.levels[level - 1];
    hierarchy.levels[level].first_cell = CellId(static_cast<std::uint32_t>(hierarchy.cells.size()));
    for (CellId p = above.first_cell; p < above.end_cell(); ++p) {
      hierarchy.cells[p].first_child = CellId(static_cast<std::uint32_t>(hierarchy.cells.size()));
      for (const Box3f& box : children_of(p)) {
        Cell cell;
        cell.parent = p;
        cell.bounds = box;
        hierarchy.cells.push_back(cell);
        ++hierarchy.cells[p].child_count;
      }
    }
    hierarchy.levels[level].cell_count =
        static_cast<std::uint32_t>(hierarchy.cells.size()) - hierarchy.levels[level].first_cell;
  }

  float radius_of(CellId cell) const { return radii.select[static_cast<std::size_t>(hierarchy.level_of(cell))]; }
  bool needs(CellId cell, Vec3f viewpoint) const {
    return hierarchy.cells[cell].child_count > 0 && excess(hierarchy, radii, viewpoint, cell) > 0;
  }
  // Boxes are nested and radii decrease, so that what is needed has all above it needed, too.
  std::vector<CellId> needed(Vec3f viewpoint) const {
    std::vector<CellId> all;
    for (CellId c{0}; c < hierarchy.cells.size(); ++c)
      if (needs(c, viewpoint)) all.push_back(c);
    return all;
  }
  std::uint64_t bytes_of(const auto& families) const {
    return std::accumulate(families.begin(), families.end(), std::uint64_t{0},
                           [&](std::uint64_t sum, CellId c) { return sum + bytes[c]; });
  }

  Hierarchy hierarchy;
  Radii radii;
  std::vector<std::uint64_t> bytes;
};

// A view of random tables, and a budget for a part of what it needs.
struct Case {
  explicit Case(std::mt19937& random, std::optional<DistanceMetric> metric = {})
      : tables(random), viewpoint(random_point(random)) {
    tables.radii.metric = metric.value_or(tables.radii.metric);
    needed = tables.needed(viewpoint);
    need = tables.bytes_of(needed);
    room = static_cast<std::uint64_t>(uniform(random, 0, 1.2f) * static_cast<float>(need));
  }
  std::vector<CellId> choose() const {
    return choose_families(tables.hierarchy, tables.radii, viewpoint, {tables.bytes, room});
  }

  Tables tables;
  Vec3f viewpoint;
  std::vector<CellId> needed;
  std::uint64_t need = 0, room = 0;
};

}  // namespace lodestone::testing
