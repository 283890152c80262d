// Check of the errors: measured again, with a search structure over the whole coarser level, where the builder looks
// around the parents only.
#include <algorithm>
#include <cmath>

#include "core/distance/triangle_bvh.h"
#include "core/hierarchy/verify_checks.h"

namespace lodestone::verify {
namespace {

// What single precision in the builder may lose on a distance.
constexpr double relative_slack = 1e-4, absolute_slack = 1e-7;

constexpr std::size_t vertices_measured = 250'000;  // per level, about

// The surface of a level without regard to identity: copies of a vertex do not matter to distances.
TriangleBvh surface_of(const Hierarchy& hierarchy, int level) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  for (const Cell& cell : hierarchy.cells_of(level)) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const Vec3f p : cell.positions) positions.push_back(to_double(p));
    for (const Triangle& t : cell.triangles) triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
  }
  return TriangleBvh(positions, triangles);
}

// A cell's error covers those of its children and the way from their vertices to the coarser surface.
void check_measured(const Hierarchy& hierarchy, int coarse, Finding& errors) {
  const Level& level = hierarchy.levels[static_cast<std::size_t>(coarse)];
  if (level.triangles == 0) return;
  const TriangleBvh surface = surface_of(hierarchy, coarse);
  const std::uint64_t fine_vertices = hierarchy.levels[static_cast<std::size_t>(coarse) + 1].vertices;
  const std::size_t stride = 1 + fine_vertices / vertices_measured;
  std::uint32_t hint = TriangleBvh::no_hint;
  std::size_t number = 0;
  for (std::uint32_t c = level.first_cell; c < level.first_cell + level.cell_count; ++c) {
    const Cell& cell = hierarchy.cells[c];
    for (std::uint32_t k = cell.first_child; k < cell.first_child + cell.child_count; ++k) {
      const Cell& child = hierarchy.cells[k];
      for (std::size_t v = 0; v < child.positions.size(); ++v) {
        // Vertices that do not move say nothing.
        if (number++ % stride != 0 || child.positions[v] == cell.positions[child.parents[v]]) continue;
        const TriangleBvh::Nearest nearest = surface.nearest(to_double(child.positions[v]), hint);
        hint = nearest.slot;
        // The image of an island that has collapsed is a point or a line: it counts, although nothing draws it.
        const double moved2 =
            squared_length(to_double(child.positions[v]) - to_double(cell.positions[child.parents[v]]));
        const double needed = double{child.error} + std::sqrt(std::min(nearest.squared_distance, moved2));
        errors.require(cell.error * (1 + relative_slack) + absolute_slack >= needed, [&] {
          return place(coarse + 1, k, v) + ": " + std::to_string(needed) +
                 " from M_L, but the parent cell's error is " + std::to_string(cell.error);
        });
      }
    }
  }
}

}  // namespace

void check_errors(const Hierarchy& hierarchy, Finding& errors) {
  for (int l = 0; l <= hierarchy.finest(); ++l) {
    const Level& level = hierarchy.levels[static_cast<std::size_t>(l)];
    double largest = 0;
    for (std::uint32_t c = level.first_cell; c < level.first_cell + level.cell_count; ++c) {
      const Cell& cell = hierarchy.cells[c];
      // A corner of the input is at most half a diagonal of the lattice from its vertex, and so is every point between.
      const int bits = hierarchy.transform.lattice.bits;
      const double moved = l == hierarchy.finest() && bits > 0 ? std::sqrt(0.75) * std::ldexp(1.0, -bits) : 0;
      double least = moved, most = moved;
      for (std::uint32_t k = cell.first_child; k < cell.first_child + cell.child_count; ++k) {
        const Cell& child = hierarchy.cells[k];
        least = std::max(least, double{child.error});
        most = std::max(most, double{child.error} + child.max_displacement);
      }
      errors.require(cell.error >= least && cell.error <= most * (1 + 1e-6), [&] {
        return place(l, c) + ": error " + std::to_string(cell.error) + " stored, its children allow " +
               std::to_string(least) + " to " + std::to_string(most);
      });
      largest = std::max(largest, double{cell.error});
    }
    check_bound(errors, "error", l, level.error, largest / cell_size(l));
    if (l < hierarchy.finest()) check_measured(hierarchy, l, errors);
  }
}

}  // namespace lodestone::verify
