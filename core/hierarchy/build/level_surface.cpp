// Bounding volume hierarchies (ericson2005, chapter 6), split at the median of the centres along the longest side.
#include "core/hierarchy/build/level_surface.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <span>

#include "core/spatial/point_triangle.h"

namespace lodestone {
namespace {

constexpr std::uint32_t leaf_items = 4;
constexpr std::size_t most_waiting = 64;  // medians halve: a tree over 2^32 items is 32 deep

double squared_distance(Vec3d p, const Box3f& box) {
  const auto outside = [](double lo, double hi, double v) { return std::max(std::max(lo - v, v - hi), 0.0); };
  const double x = outside(box.lo.x, box.hi.x, p.x), y = outside(box.lo.y, box.hi.y, p.y),
               z = outside(box.lo.z, box.hi.z, p.z);
  return (x * x + y * y) + z * z;
}

Vec3f twice_centre(const Box3f& box) { return box.lo + box.hi; }

float along(Vec3f v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

bool overlap(const Box3f& a, const Box3f& b) {
  return a.lo.x <= b.hi.x && a.lo.y <= b.hi.y && a.lo.z <= b.hi.z && b.lo.x <= a.hi.x && b.lo.y <= a.hi.y &&
         b.lo.z <= a.hi.z;
}

// Grown on all sides, and a little more for the roundings.
Box3f grown(const Box3f& box, double distance) {
  const auto by = static_cast<float>(distance * (1 + 1e-6) + 1e-6);
  return {box.lo - Vec3f{by, by, by}, box.hi + Vec3f{by, by, by}};
}

int longest_side(Vec3f extent) {
  if (extent.x >= extent.y && extent.x >= extent.z) return 0;
  return extent.y >= extent.z ? 1 : 2;
}

}  // namespace

// Makes a tree over parts; the numbers of the parts become the items, leaf after leaf.
class LevelSurface::Builder {
 public:
  Builder(std::vector<Part>& parts, std::uint32_t in_leaf, Tree& tree) : parts_(parts), in_leaf_(in_leaf), tree_(tree) {
    tree_.items.reserve(parts.size());
    tree_.nodes.reserve(2 * parts.size() / in_leaf);
    tree_.root = build(0, static_cast<std::uint32_t>(parts.size()), tree_.box);
    tree_.nodes.shrink_to_fit();
  }

 private:
  // The order within a leaf and the two sides of a median depend on the parts alone, not on the library's nth_element.
  std::uint32_t build(std::uint32_t first, std::uint32_t end, Box3f& box) {
    const std::span<Part> parts = std::span(parts_).subspan(first, end - first);
    box = {};
    for (const Part& part : parts) box.extend(part.box);
    if (parts.size() <= in_leaf_) {
      std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.number < b.number; });
      for (const Part& part : parts) tree_.items.push_back(part.number);
      return leaf_bit | first << 2 | (end - first - 1);
    }
    Box3f centres;
    for (const Part& part : parts) centres.extend(twice_centre(part.box));
    const int axis = longest_side(centres.hi - centres.lo);
    const std::size_t half = parts.size() / 2;
    std::nth_element(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(half), parts.end(),
                     [axis](const Part& a, const Part& b) {
                       const float u = along(twice_centre(a.box), axis), v = along(twice_centre(b.box), axis);
                       return u != v ? u < v : a.number < b.number;
                     });
    const auto number = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.emplace_back();
    const auto middle = first + static_cast<std::uint32_t>(half);
    Node node;
    node.child[0] = build(first, middle, node.box[0]);
    node.child[1] = build(middle, end, node.box[1]);
    tree_.nodes[number] = node;
    return number;
  }

  std::vector<Part>& parts_;
  std::uint32_t in_leaf_;
  Tree& tree_;
};

// A branch of a tree, and how far it is at least.
struct LevelSurface::Waiting {
  double squared_distance = 0;
  std::uint32_t child = 0;
};

LevelSurface::LevelSurface(const Hierarchy& hierarchy, int level)
    : cells_(hierarchy.cells_of(level)),
      first_cell_(hierarchy.levels[static_cast<std::size_t>(level)].first_cell),
      trees_(cells_.size()) {}

void LevelSurface::build_cell(std::uint32_t cell) {
  const Cell& from = cells_[cell];
  std::vector<Part> parts;
  parts.reserve(from.triangles.size());
  std::vector<char> used(from.positions.size(), 0);
  for (std::uint32_t t = 0; t < from.triangles.size(); ++t) {
    Part part{{}, t};
    for (const std::uint32_t v : from.triangles[t].v) {
      part.box.extend(from.positions[v]);
      used[v] = 1;
    }
    parts.push_back(part);
  }
  for (std::uint32_t v = 0; v < from.positions.size(); ++v) {
    if (used[v]) continue;
    Part point{{}, static_cast<std::uint32_t>(from.triangles.size()) + v};
    point.box.extend(from.positions[v]);
    parts.push_back(point);
  }
  assert(!parts.empty());
  Builder(parts, leaf_items, trees_[cell]);
}

void LevelSurface::build_rest() {
  std::vector<Part> parts;
  for (std::uint32_t cell = 0; cell < trees_.size(); ++cell) parts.push_back({trees_[cell].box, cell});
  Builder(parts, 1, top_);
}

std::array<LevelSurface::Branch, 2> LevelSurface::halves(const Branch& branch) const {
  const Node& node = trees_[branch.cell].nodes[branch.child];
  return {Branch{branch.cell, node.child[0], node.box[0]}, Branch{branch.cell, node.child[1], node.box[1]}};
}

LevelSurface::Corners LevelSurface::corners(SurfaceItem item) const {
  const Cell& cell = cells_[item.cell - first_cell_];
  if (item.number < cell.triangles.size()) {
    const auto& v = cell.triangles[item.number].v;
    return {to_double(cell.positions[v[0]]), to_double(cell.positions[v[1]]), to_double(cell.positions[v[2]])};
  }
  const Vec3d point = to_double(cell.positions[item.number - cell.triangles.size()]);
  return {point, point, point};
}

void LevelSurface::take(std::uint32_t cell, std::uint32_t number, Vec3d p, Nearest& best) const {
  const SurfaceItem item{first_cell_ + cell, number};
  const auto [a, b, c] = corners(item);
  const double squared = nearest_on_triangle(p, a, b, c).squared_distance;
  if (squared < best.squared_distance) best = {squared, item};
}

void LevelSurface::search_cell(std::uint32_t cell, Vec3d p, double enough, Nearest& best) const {
  const Tree& tree = trees_[cell];
  std::array<Waiting, most_waiting> stack;
  std::size_t size = 0;
  std::uint32_t at = tree.root;
  for (;;) {
    if (at & leaf_bit) {
      const std::uint32_t first = leaf_first(at), end = first + leaf_count(at);
      for (std::uint32_t i = first; i < end; ++i) take(cell, tree.items[i], p, best);
      if (best.squared_distance <= enough) return;
    } else {
      const Node& node = tree.nodes[at];
      const double d[2] = {squared_distance(p, node.box[0]), squared_distance(p, node.box[1])};
      const int near = d[1] < d[0];
      if (d[1 - near] < best.squared_distance) stack[size++] = {d[1 - near], node.child[1 - near]};
      if (d[near] < best.squared_distance) {
        at = node.child[near];
        continue;
      }
    }
    do {
      if (size == 0) return;
      at = stack[--size].child;
    } while (!(stack[size].squared_distance < best.squared_distance));
  }
}

Box3f LevelSurface::box_of(std::uint32_t cell, std::uint32_t number) const {
  const Cell& from = cells_[cell];
  Box3f box;
  if (number < from.triangles.size()) {
    for (const std::uint32_t v : from.triangles[number].v) box.extend(from.positions[v]);
  } else {
    box.extend(from.positions[number - from.triangles.size()]);
  }
  return box;
}

void LevelSurface::gather_cell(std::uint32_t cell, const Box3f& box, std::size_t most,
                               std::vector<SurfaceItem>& items) const {
  const Tree& tree = trees_[cell];
  std::array<std::uint32_t, most_waiting> stack;
  std::size_t size = 0;
  stack[size++] = tree.root;
  while (size > 0) {
    const std::uint32_t at = stack[--size];
    if (at & leaf_bit) {
      const std::uint32_t first = leaf_first(at), end = first + leaf_count(at);
      for (std::uint32_t i = first; i < end; ++i)
        if (overlap(box_of(cell, tree.items[i]), box)) items.push_back({first_cell_ + cell, tree.items[i]});
      if (items.size() > most) return;
      continue;
    }
    const Node& node = tree.nodes[at];
    for (const int side : {1, 0})
      if (overlap(node.box[side], box)) stack[size++] = node.child[side];
  }
}

void LevelSurface::gather(const Box3f& box, double distance, std::size_t most, std::vector<SurfaceItem>& items) const {
  const Box3f around = grown(box, distance);
  std::array<std::uint32_t, most_waiting> stack;
  std::size_t size = 0;
  stack[size++] = top_.root;
  while (size > 0 && items.size() <= most) {
    const std::uint32_t at = stack[--size];
    if (at & leaf_bit) {
      const std::uint32_t cell = top_.items[leaf_first(at)];
      if (overlap(trees_[cell].box, around)) gather_cell(cell, around, most, items);
      continue;
    }
    const Node& node = top_.nodes[at];
    for (const int side : {1, 0})
      if (overlap(node.box[side], around)) stack[size++] = node.child[side];
  }
}

LevelSurface::Nearest LevelSurface::nearest(Vec3d p, SurfaceItem hint, double enough) const {
  Nearest best{std::numeric_limits<double>::infinity(), {}};
  if (hint.cell != no_cell) take(hint.cell - first_cell_, hint.number, p, best);
  if (best.squared_distance <= enough) return best;
  std::array<Waiting, most_waiting> stack;
  std::size_t size = 0;
  stack[size++] = {squared_distance(p, top_.box), top_.root};
  while (size > 0) {
    const Waiting next = stack[--size];
    if (!(next.squared_distance < best.squared_distance)) continue;
    if (next.child & leaf_bit) {
      search_cell(top_.items[leaf_first(next.child)], p, enough, best);
      if (best.squared_distance <= enough) return best;
      continue;
    }
    const Node& node = top_.nodes[next.child];
    const double d[2] = {squared_distance(p, node.box[0]), squared_distance(p, node.box[1])};
    const int near = d[1] < d[0];
    stack[size++] = {d[1 - near], node.child[1 - near]};
    stack[size++] = {d[near], node.child[near]};
  }
  return best;
}

}  // namespace lodestone
