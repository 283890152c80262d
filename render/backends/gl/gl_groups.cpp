#include "render/backends/gl/gl_groups.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "core/base/error.h"

namespace lodestone {
namespace {

// Draw commands count indices in 32 bits.
constexpr std::uint64_t max_indices = std::numeric_limits<std::uint32_t>::max();

std::vector<std::uint32_t> depth_first(const Hierarchy& hierarchy) {
  std::vector<std::uint32_t> order, open;
  order.reserve(hierarchy.cells.size());
  if (!hierarchy.cells.empty()) open.push_back(0);
  while (!open.empty()) {
    const std::uint32_t cell = open.back();
    open.pop_back();
    order.push_back(cell);
    const Cell& c = hierarchy.cells[cell];
    for (std::uint32_t k = c.child_count; k-- > 0;) open.push_back(c.first_child + k);
  }
  assert(order.size() == hierarchy.cells.size());
  return order;
}

class Planner {
 public:
  Planner(const Hierarchy& hierarchy, std::uint64_t max_vertices)
      : hierarchy_(hierarchy), max_vertices_(max_vertices), group_of_(hierarchy.cells.size(), none) {}

  std::vector<CellGroup> run() {
    for (const std::uint32_t cell : depth_first(hierarchy_)) add(cell);
    return std::move(groups_);
  }

 private:
  static constexpr std::uint32_t none = 0xffff'ffffu;

  [[nodiscard]] std::uint64_t vertices(std::uint32_t cell) const { return hierarchy_.cells[cell].positions.size(); }

  // Is the parent of this cell in the group that is being filled?
  [[nodiscard]] bool has_parent(std::uint32_t cell) const {
    const std::uint32_t parent = hierarchy_.cells[cell].parent;
    if (parent == no_cell || group_of_[parent] == groups_.size() - 1) return true;
    const std::vector<std::uint32_t>& halo = groups_.back().halo;
    return std::find(halo.begin(), halo.end(), parent) != halo.end();
  }

  [[nodiscard]] bool fits(std::uint32_t cell) const {
    const Cell& c = hierarchy_.cells[cell];
    const std::uint64_t needed = vertices(cell) + (has_parent(cell) ? 0 : vertices(c.parent));
    return groups_.back().vertices + needed <= max_vertices_ &&
           groups_.back().indices + 3 * c.triangles.size() <= max_indices;
  }

  void add(std::uint32_t cell) {
    if (groups_.empty() || !fits(cell)) groups_.emplace_back();
    if (!fits(cell))
      throw ResourceError(
          describe("", "OpenGL",
                   "a cell and its parent exceed a storage block of " + std::to_string(max_vertices_) + " vertices",
                   "build with smaller cells or use --backend soft"));
    CellGroup& group = groups_.back();
    if (!has_parent(cell)) {
      group.halo.push_back(hierarchy_.cells[cell].parent);
      group.vertices += vertices(group.halo.back());
    }
    group_of_[cell] = static_cast<std::uint32_t>(groups_.size() - 1);
    group.cells.push_back(cell);
    group.vertices += vertices(cell);
    group.indices += 3 * hierarchy_.cells[cell].triangles.size();
  }

  const Hierarchy& hierarchy_;
  const std::uint64_t max_vertices_;
  std::vector<std::uint32_t> group_of_;
  std::vector<CellGroup> groups_;
};

// Lays the cells of a group one after the other, then its halo.
void place(const Hierarchy& hierarchy, const CellGroup& group, std::uint32_t number, std::vector<CellPlace>& places) {
  std::uint64_t vertex = 0, index = 0;
  for (const std::uint32_t cell : group.cells) {
    places[cell] = {number, static_cast<std::uint32_t>(vertex), 0, static_cast<std::uint32_t>(index)};
    vertex += hierarchy.cells[cell].positions.size();
    index += 3 * hierarchy.cells[cell].triangles.size();
  }
  std::vector<std::uint64_t> halo_first;
  for (const std::uint32_t cell : group.halo) {
    halo_first.push_back(vertex);
    vertex += hierarchy.cells[cell].positions.size();
  }
  for (const std::uint32_t cell : group.cells) {
    const std::uint32_t parent = hierarchy.cells[cell].parent;
    if (parent == no_cell) continue;
    const auto in_halo = std::find(group.halo.begin(), group.halo.end(), parent);
    places[cell].parent_first_vertex =
        in_halo == group.halo.end()
            ? places[parent].first_vertex
            : static_cast<std::uint32_t>(halo_first[static_cast<std::size_t>(in_halo - group.halo.begin())]);
  }
}

}  // namespace

CellGroups plan_groups(const Hierarchy& hierarchy, std::uint64_t max_vertices) {
  CellGroups plan;
  plan.groups = Planner(hierarchy, max_vertices).run();
  plan.places.resize(hierarchy.cells.size());
  for (std::uint32_t g = 0; g < plan.groups.size(); ++g) place(hierarchy, plan.groups[g], g, plan.places);
  return plan;
}

}  // namespace lodestone
