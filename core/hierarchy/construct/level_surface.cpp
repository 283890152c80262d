#include "core/hierarchy/construct/level_surface.h"

#include <algorithm>
#include <limits>

#include "core/spatial/part_boxes.h"
#include "core/spatial/point_triangle.h"

namespace lodestone {
namespace {

constexpr std::uint32_t leaf_items = 4;
constexpr std::size_t most_tested = 8;  // items per item that is gathered

bool overlap(const Box3f& a, const Box3f& b) {
  return a.lo.x <= b.hi.x && a.lo.y <= b.hi.y && a.lo.z <= b.hi.z && b.lo.x <= a.hi.x && b.lo.y <= a.hi.y &&
         b.lo.z <= a.hi.z;
}

// Grown on all sides, and a little more for the roundings.
Box3f grown(const Box3f& box, double distance) {
  const auto by = static_cast<float>(distance * (1 + 1e-6) + 1e-6);
  return {box.lo - Vec3f{by, by, by}, box.hi + Vec3f{by, by, by}};
}

// Removes repeated items from `first` on, all of one cell: a needle comes once for each of its parts.
void keep_once(std::vector<SurfaceItem>& items, std::ptrdiff_t first) {
  std::sort(items.begin() + first, items.end(),
            [](const SurfaceItem& a, const SurfaceItem& b) { return a.number < b.number; });
  items.erase(std::unique(items.begin() + first, items.end(),
                          [](const SurfaceItem& a, const SurfaceItem& b) { return a.number == b.number; }),
              items.end());
}

}  // namespace

LevelSurface::LevelSurface(const Hierarchy& hierarchy, int level)
    : cells_(hierarchy.cells_of(level)),
      level_(hierarchy.levels[static_cast<std::size_t>(level)]),
      trees_(cells_.size()),
      parts_(cells_.size()) {}

void LevelSurface::build_cell(CellRank cell) {
  const Cell& from = cells_[cell];
  const auto triangles = static_cast<std::uint32_t>(from.triangles.size());
  std::vector<BoxTree::Item> items;
  items.reserve(triangles);
  std::vector<char> used(from.positions.size(), 0);
  for (std::uint32_t t = 0; t < triangles; ++t) {
    items.push_back({box_of(cell, t), t});
    for (const std::uint32_t v : from.triangles[t].v) used[v] = 1;
  }
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (!used[v]) items.push_back({box_of(cell, triangles + v), triangles + v});
  const std::size_t undivided = items.size();
  std::vector<BoxTree::Item> parts = items;
  divide_boxes(
      parts, triangles,
      [&](std::uint32_t t) {
        return corners({level_.id_of(cell), t});
      },
      std::size_t{2} * triangles);
  trees_[cell] = BoxTree(std::move(items), leaf_items);
  if (parts.size() == undivided) return;
  BoxTree& tree = parts_[cell] = BoxTree(std::move(parts), leaf_items);
  // Points are the triangles of equal corners that corners() makes of them.
  const auto corners_of = [&](std::uint32_t slot) { return corners({level_.id_of(cell), tree.items()[slot]}); };
  const auto count = static_cast<std::uint32_t>(tree.items().size());
  if (count > 2 * undivided && are_side_by_side(count, corners_of)) tree.add_slabs(corners_of);
}

void LevelSurface::build_rest() {
  std::vector<BoxTree::Item> items;
  for (CellRank cell{0}; cell < trees_.size(); ++cell) items.push_back({trees_[cell].root().box, cell});
  top_ = BoxTree(std::move(items), 1);
}

Box3f LevelSurface::box_of(CellRank cell, std::uint32_t number) const {
  const Cell& from = cells_[cell];
  Box3f box;
  if (number < from.triangles.size()) {
    for (const std::uint32_t v : from.triangles[number].v) box.extend(from.positions[v]);
  } else {
    box.extend(from.positions[number - from.triangles.size()]);
  }
  return box;
}

LevelSurface::Corners LevelSurface::corners(SurfaceItem item) const {
  const Cell& cell = cells_[level_.rank_of(item.cell)];
  if (item.number < cell.triangles.size()) {
    const auto& v = cell.triangles[item.number].v;
    return {to_double(cell.positions[v[0]]), to_double(cell.positions[v[1]]), to_double(cell.positions[v[2]])};
  }
  const Vec3d point = to_double(cell.positions[item.number - cell.triangles.size()]);
  return {point, point, point};
}

void LevelSurface::take(CellRank cell, std::uint32_t number, Vec3d p, Nearest& best) const {
  const SurfaceItem item{level_.id_of(cell), number};
  const auto [a, b, c] = corners(item);
  const double squared = nearest_on_triangle(p, a, b, c).squared_distance;
  ++best.tested;
  if (squared < best.squared_distance) best.squared_distance = squared, best.item = item;
}

LevelSurface::Gathered LevelSurface::gather(const Box3f& box, double distance, std::size_t limit,
                                            std::vector<SurfaceItem>& items) const {
  const Box3f around = grown(box, distance);
  const auto accepts = [&](const Box3f& other) { return overlap(other, around); };
  const Vec3d lo = to_double(around.lo), hi = to_double(around.hi), middle = 0.5 * (lo + hi);
  const double far = 0.5 * length(hi - lo) * (1 + 1e-9);
  Gathered result;
  top_.walk(accepts, [&](BoxTree::Slots top) {
    const CellRank cell(top_.items()[top.begin]);
    const bool divided = !parts_[cell].items().empty();
    const BoxTree& tree = parts(cell);
    if (!accepts(tree.root().box)) return false;
    const auto first = static_cast<std::ptrdiff_t>(items.size());
    const auto is_near = [&](SurfaceItem item) {
      if (!accepts(box_of(cell, item.number))) return false;
      if (!divided || tree.has_slabs()) return true;
      const auto [a, b, c] = corners(item);  // the boxes of needles say little, unlike slabs
      return nearest_on_triangle(middle, a, b, c).squared_distance <= far * far;
    };
    const auto take_slots = [&](BoxTree::Slots slots) {
      for (std::uint32_t i = slots.begin; i < slots.end; ++i)
        if (const SurfaceItem item{level_.id_of(cell), tree.items()[i]}; is_near(item)) items.push_back(item);
      result.tested += slots.end - slots.begin;
      if (items.size() > limit && divided) keep_once(items, first);
      result.complete = items.size() <= limit && result.tested <= most_tested * limit;
      return !result.complete;
    };
    if (tree.has_slabs()) {
      tree.search(middle, far * far, take_slots);  // boxes alone would lead to all needles that cross the place
    } else {
      tree.walk(accepts, take_slots);
    }
    if (divided) keep_once(items, first);
    return !result.complete;
  });
  return result;
}

LevelSurface::Nearest LevelSurface::nearest(Vec3d p, SurfaceItem hint, const Until& until) const {
  Nearest best{std::numeric_limits<double>::infinity(), {}};
  if (hint.cell != no_cell) take(level_.rank_of(hint.cell), hint.number, p, best);
  if (best.squared_distance <= until.enough) return best;
  const auto ends = [&] {
    if (best.tested >= until.most) best.complete = false;
    return !best.complete || best.squared_distance <= until.enough;
  };
  top_.search(p, best.squared_distance, [&](BoxTree::Slots top) {
    const CellRank cell(top_.items()[top.begin]);
    const BoxTree& tree = parts(cell);
    if (!(squared_distance(p, tree.root().box) < best.squared_distance)) return false;
    tree.search(p, best.squared_distance, [&](BoxTree::Slots slots) {
      for (std::uint32_t i = slots.begin; i < slots.end; ++i) take(cell, tree.items()[i], p, best);
      return ends();
    });
    return ends();
  });
  return best;
}

}  // namespace lodestone
