// A bounding volume hierarchy over boxes of numbered items: the one tree behind every search for near or intersected
// items. It knows the boxes alone; callers test the items of the leaves that it visits.
//
// Binary, boxes of both children in one node, at most four items per leaf. Boxes are float, distances from them double.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/math/vec3.h"
#include "core/spatial/needle_slabs.h"

namespace lodestone {

[[nodiscard]] inline double squared_distance(Vec3d p, const Box3f& box) {
  const auto outside = [](double lo, double hi, double v) { return std::max(std::max(lo - v, v - hi), 0.0); };
  const double x = outside(box.lo.x, box.hi.x, p.x), y = outside(box.lo.y, box.hi.y, p.y),
               z = outside(box.lo.z, box.hi.z, p.z);
  return (x * x + y * y) + z * z;
}

// Extends the box by a point, rounded outwards.
void extend(Box3f& box, Vec3d p);

// A line from + t direction, for tests against many boxes.
class BoxLine {
 public:
  BoxLine(Vec3d from, Vec3d direction)
      : from_(from), inverse_{inverse_of(direction.x), inverse_of(direction.y), inverse_of(direction.z)} {}

  // Clips [first, last] to the part of the line that is in the box grown by `distance` on all sides.
  [[nodiscard]] std::pair<double, double> clip(const Box3f& box, double distance, double first, double last) const {
    const auto axis = [&](double lo, double hi, double origin, double scale) {
      const double a = (lo - distance - origin) * scale, b = (hi + distance - origin) * scale;
      first = std::max(first, std::min(a, b)), last = std::min(last, std::max(a, b));
    };
    axis(box.lo.x, box.hi.x, from_.x, inverse_.x);
    axis(box.lo.y, box.hi.y, from_.y, inverse_.y);
    axis(box.lo.z, box.hi.z, from_.z, inverse_.z);
    return {first, last};
  }

 private:
  static double inverse_of(double v) { return 1 / (v == 0 ? 1e-300 : v); }
  Vec3d from_, inverse_;  // inverse_: finite
};

class BoxTree {
 public:
  struct Item {
    Box3f box;
    std::uint32_t number = 0;
  };
  // A subtree: a leaf has items, any other branch two halves.
  struct Branch {
    Box3f box;
    std::uint32_t child = 0;  // a node; or a leaf: leaf_bit, number of the first slot, count - 1 in the low two bits
    [[nodiscard]] bool is_leaf() const { return (child & leaf_bit) != 0; }
  };
  // Positions in items().
  struct Slots {
    std::uint32_t begin = 0, end = 0;
  };

  BoxTree() = default;
  // Splits at the median of the centres along the longest side (ericson2005, chapter 6). At least one item, in_leaf
  // from 1 to 4. The result depends on the items alone, not on the library's nth_element. About 20 bytes per item.
  BoxTree(std::vector<Item> items, std::uint32_t in_leaf);
  // Splits where the codes of the items, ascending, first differ (Karras 2012, sequentially): faster to build. Items
  // keep their order; box_of(slot) is the box of one.
  struct Code {
    std::uint64_t morton = 0;
    std::uint32_t number = 0;
  };
  template <class BoxOf>
  BoxTree(std::span<const Code> codes, const BoxOf& box_of);

  [[nodiscard]] const Branch& root() const { return root_; }
  [[nodiscard]] const std::vector<std::uint32_t>& items() const { return items_; }  // their numbers, leaf after leaf
  [[nodiscard]] std::array<Branch, 2> halves(const Branch& branch) const {
    const Node& node = nodes_[branch.child];
    return {Branch{node.box[0], node.child[0]}, Branch{node.box[1], node.child[1]}};
  }
  [[nodiscard]] static Slots slots(const Branch& leaf) { return slots_of(leaf.child); }

  // Narrows what search() visits where needles lie side by side. corners_of(slot): a triangle that holds what is
  // searched for in the item. O(n log n); about 20 bytes per item.
  template <class CornersOf>
  void add_slabs(const CornersOf& corners_of);
  [[nodiscard]] bool has_slabs() const { return !slabs_.empty(); }

  // Calls visit(slots) for the leaves whose boxes are nearer to p than the squared distance `bound`, near ones first.
  // visit() lowers the bound; it returns true to end the search.
  template <class Visit>
  void search(Vec3d p, const double& bound, const Visit& visit) const;
  // Calls visit(slots) for the leaves for which accepts(box) holds on the way down, in order; the root is always
  // accepted. visit() returns true to end the walk.
  template <class Accepts, class Visit>
  void walk(const Accepts& accepts, const Visit& visit) const;

 private:
  static constexpr std::uint32_t leaf_bit = 0x8000'0000u;
  static constexpr std::uint32_t code_leaf = 4;         // items per leaf of a tree by codes
  static constexpr std::uint32_t most_in_slabs = 4096;  // items of a node; more of them point in many directions
  static constexpr std::size_t max_depth = 128;         // by codes: 63 splits between different ones, 32 between equal
  struct Node {
    Box3f box[2];
    std::uint32_t child[2]{};
  };
  [[nodiscard]] static constexpr std::uint32_t leaf_of(std::uint32_t first, std::uint32_t count) {
    return leaf_bit | first << 2 | (count - 1);
  }
  [[nodiscard]] static constexpr Slots slots_of(std::uint32_t leaf) {
    const std::uint32_t first = (leaf & ~leaf_bit) >> 2;
    return {first, first + (leaf & 3) + 1};
  }
  Branch build(std::span<Item> items, std::uint32_t first, std::uint32_t in_leaf);
  template <class BoxOf>
  Branch build(std::span<const Code> codes, Slots range, const BoxOf& box_of);
  [[nodiscard]] static std::uint32_t split(std::span<const Code> codes, Slots range);
  Branch join(std::uint32_t number, const Branch& left, const Branch& right);
  struct Needles {
    NeedleDirections directions;
    Slots slots;
  };
  template <class CornersOf>
  Needles add_slabs(std::uint32_t child, const CornersOf& corners_of);
  template <bool with_slabs, class Visit>
  void search_nodes(Vec3d p, const double& bound, const Visit& visit) const;

  std::vector<Node> nodes_;
  std::vector<NeedleSlabs> slabs_;  // of the nodes; empty: none
  std::vector<std::uint32_t> items_;
  Branch root_;
};

template <class BoxOf>
BoxTree::BoxTree(std::span<const Code> codes, const BoxOf& box_of) {
  assert(!codes.empty() && codes.size() <= (1u << 29));
  items_.reserve(codes.size());
  for (const Code& code : codes) items_.push_back(code.number);
  nodes_.reserve(codes.size() / 2);
  root_ = build(codes, {0, static_cast<std::uint32_t>(codes.size())}, box_of);
}

template <class BoxOf>
BoxTree::Branch BoxTree::build(std::span<const Code> codes, Slots range, const BoxOf& box_of) {
  if (range.end - range.begin <= code_leaf) {
    Branch leaf{{}, leaf_of(range.begin, range.end - range.begin)};
    for (std::uint32_t slot = range.begin; slot < range.end; ++slot) leaf.box.extend(box_of(slot));
    return leaf;
  }
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  const std::uint32_t middle = split(codes, range);
  const Branch left = build(codes, {range.begin, middle}, box_of), right = build(codes, {middle, range.end}, box_of);
  return join(number, left, right);
}

template <class CornersOf>
void BoxTree::add_slabs(const CornersOf& corners_of) {
  slabs_.resize(nodes_.size());
  (void)add_slabs(root_.child, corners_of);
}

template <class CornersOf>
BoxTree::Needles BoxTree::add_slabs(std::uint32_t child, const CornersOf& corners_of) {
  if (child & leaf_bit) {
    Needles needles{{}, slots_of(child)};
    for (std::uint32_t slot = needles.slots.begin; slot < needles.slots.end; ++slot)
      needles.directions.add(NeedleDirections(corners_of(slot)));
    return needles;
  }
  Needles below[2];
  for (const int side : {0, 1}) below[side] = add_slabs(nodes_[child].child[side], corners_of);
  Needles needles{below[0].directions, {below[0].slots.begin, below[1].slots.end}};
  needles.directions.add(below[1].directions);
  if (needles.slots.end - needles.slots.begin > most_in_slabs) return needles;
  NeedleSlabs slabs(needles.directions);
  for (const int side : {0, 1})
    for (std::uint32_t slot = below[side].slots.begin; slot < below[side].slots.end; ++slot)
      slabs.extend(side, corners_of(slot));
  slabs_[child] = slabs;
  return needles;
}

template <class Visit>
void BoxTree::search(Vec3d p, const double& bound, const Visit& visit) const {
  if (slabs_.empty()) return search_nodes<false>(p, bound, visit);
  search_nodes<true>(p, bound, visit);
}

template <bool with_slabs, class Visit>
void BoxTree::search_nodes(Vec3d p, const double& bound, const Visit& visit) const {
  struct Waiting {
    double squared_distance;
    std::uint32_t child;
  };
  std::array<Waiting, max_depth> stack;
  std::size_t size = 0;
  std::uint32_t at = root_.child;
  for (;;) {
    if (at & leaf_bit) {
      if (visit(slots_of(at))) return;
    } else {
      const Node& node = nodes_[at];
      std::array<double, 2> d{squared_distance(p, node.box[0]), squared_distance(p, node.box[1])};
      if constexpr (with_slabs) {
        const std::array<double, 2> across = slabs_[at].squared_distances(p);
        d = {std::max(d[0], across[0]), std::max(d[1], across[1])};
      }
      const std::size_t near = d[1] < d[0];
      if (d[1 - near] < bound) stack[size++] = {d[1 - near], node.child[1 - near]};
      if (d[near] < bound) {
        at = node.child[near];
        continue;
      }
    }
    do {
      if (size == 0) return;
      at = stack[--size].child;
    } while (!(stack[size].squared_distance < bound));
  }
}

template <class Accepts, class Visit>
void BoxTree::walk(const Accepts& accepts, const Visit& visit) const {
  std::array<std::uint32_t, max_depth> stack;
  std::size_t size = 0;
  stack[size++] = root_.child;
  while (size > 0) {
    const std::uint32_t at = stack[--size];
    if (at & leaf_bit) {
      if (visit(slots_of(at))) return;
      continue;
    }
    const Node& node = nodes_[at];
    for (const int side : {1, 0})
      if (accepts(node.box[side])) stack[size++] = node.child[side];
  }
}

}  // namespace lodestone
