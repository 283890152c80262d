#include "core/spatial/box_tree.h"

#include <bit>

#include "core/math/round_up.h"

namespace lodestone {
namespace {

Vec3f twice_centre(const Box3f& box) { return box.lo + box.hi; }

float along(Vec3f v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

int longest_side(Vec3f extent) {
  if (extent.x >= extent.y && extent.x >= extent.z) return 0;
  return extent.y >= extent.z ? 1 : 2;
}

}  // namespace

void extend(Box3f& box, Vec3d p) {
  box.extend(Box3f{{float_down(p.x), float_down(p.y), float_down(p.z)}, {float_up(p.x), float_up(p.y), float_up(p.z)}});
}

BoxTree::BoxTree(std::vector<Item> items, std::uint32_t in_leaf) {
  assert(!items.empty() && items.size() <= (1u << 29));
  items_.reserve(items.size());
  nodes_.reserve(2 * items.size() / in_leaf);
  root_ = build(items, 0, in_leaf);
  nodes_.shrink_to_fit();
}

BoxTree::Branch BoxTree::build(std::span<Item> items, std::uint32_t first, std::uint32_t in_leaf) {
  if (items.size() <= in_leaf) {
    Branch leaf{{}, leaf_of(first, static_cast<std::uint32_t>(items.size()))};
    std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.number < b.number; });
    for (const Item& item : items) {
      leaf.box.extend(item.box);
      items_.push_back(item.number);
    }
    return leaf;
  }
  Box3f centres;
  for (const Item& item : items) centres.extend(twice_centre(item.box));
  const int axis = longest_side(centres.hi - centres.lo);
  const std::size_t half = items.size() / 2;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
                   [axis](const Item& a, const Item& b) {
                     const float u = along(twice_centre(a.box), axis), v = along(twice_centre(b.box), axis);
                     return u != v ? u < v : a.number < b.number;
                   });
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  const Branch left = build(items.first(half), first, in_leaf),
               right = build(items.subspan(half), first + static_cast<std::uint32_t>(half), in_leaf);
  return join(number, left, right);
}

BoxTree::Branch BoxTree::join(std::uint32_t number, const Branch& left, const Branch& right) {
  nodes_[number] = {{left.box, right.box}, {left.child, right.child}};
  Branch whole{left.box, number};
  whole.box.extend(right.box);
  return whole;
}

std::uint32_t BoxTree::split(std::span<const Code> codes, Slots range) {
  const std::uint64_t differing = codes[range.begin].morton ^ codes[range.end - 1].morton;
  if (differing == 0) return range.begin + (range.end - range.begin) / 2;
  const std::uint64_t bit = std::bit_floor(differing);
  const auto part = codes.subspan(range.begin, range.end - range.begin);
  const auto upper = std::partition_point(part.begin(), part.end(), [&](const Code& c) { return !(c.morton & bit); });
  return range.begin + static_cast<std::uint32_t>(upper - part.begin());
}

}  // namespace lodestone
