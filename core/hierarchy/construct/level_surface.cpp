#include "core/hierarchy/construct/level_surface.h"

#include <limits>

#include "core/spatial/point_triangle.h"

namespace lodestone {
namespace {

constexpr std::uint32_t leaf_items = 4;

bool overlap(const Box3f& a, const Box3f& b) {
  return a.lo.x <= b.hi.x && a.lo.y <= b.hi.y && a.lo.z <= b.hi.z && b.lo.x <= a.hi.x && b.lo.y <= a.hi.y &&
         b.lo.z <= a.hi.z;
}

// Grown on all sides, and a little more for the roundings.
Box3f grown(const Box3f& box, double distance) {
  const auto by = static_cast<float>(distance * (1 + 1e-6) + 1e-6);
  return {box.lo - Vec3f{by, by, by}, box.hi + Vec3f{by, by, by}};
}

}  // namespace

LevelSurface::LevelSurface(const Hierarchy& hierarchy, int level)
    : cells_(hierarchy.cells_of(level)),
      level_(hierarchy.levels[static_cast<std::size_t>(level)]),
      trees_(cells_.size()) {}

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
  trees_[cell] = BoxTree(std::move(items), leaf_items);
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
  if (squared < best.squared_distance) best = {squared, item};
}

void LevelSurface::gather(const Box3f& box, double distance, std::size_t limit, std::vector<SurfaceItem>& items) const {
  const Box3f around = grown(box, distance);
  const auto accepts = [&](const Box3f& other) { return overlap(other, around); };
  top_.walk(accepts, [&](BoxTree::Slots top) {
    const CellRank cell(top_.items()[top.begin]);
    const BoxTree& tree = trees_[cell];
    if (!accepts(tree.root().box)) return false;
    tree.walk(accepts, [&](BoxTree::Slots slots) {
      for (std::uint32_t i = slots.begin; i < slots.end; ++i)
        if (accepts(box_of(cell, tree.items()[i]))) items.push_back({level_.id_of(cell), tree.items()[i]});
      return items.size() > limit;
    });
    return items.size() > limit;
  });
}

LevelSurface::Nearest LevelSurface::nearest(Vec3d p, SurfaceItem hint, double enough) const {
  Nearest best{std::numeric_limits<double>::infinity(), {}};
  if (hint.cell != no_cell) take(level_.rank_of(hint.cell), hint.number, p, best);
  if (best.squared_distance <= enough) return best;
  top_.search(p, best.squared_distance, [&](BoxTree::Slots top) {
    const CellRank cell(top_.items()[top.begin]);
    const BoxTree& tree = trees_[cell];
    if (!(squared_distance(p, tree.root().box) < best.squared_distance)) return false;
    tree.search(p, best.squared_distance, [&](BoxTree::Slots slots) {
      for (std::uint32_t i = slots.begin; i < slots.end; ++i) take(cell, tree.items()[i], p, best);
      return best.squared_distance <= enough;
    });
    return best.squared_distance <= enough;
  });
  return best;
}

}  // namespace lodestone
