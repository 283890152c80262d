#include "core/spatial/part_boxes.h"

#include <algorithm>
#include <queue>

namespace lodestone {
namespace {

// A box is worth dividing beyond this many times the area of its triangle, some 4 for an equilateral one across the
// axes, and this many times the part of the whole box that belongs to one triangle if all have equal parts.
constexpr double over_triangle = 16, over_share = 4;
// Halves whose boxes together are larger than this share of the whole box gain nothing: a needle along an axis.
constexpr double worthwhile = 0.8;

using Corners = std::array<Vec3d, 3>;

double half_area(const Box3f& box) {
  const Vec3d side = to_double(box.hi) - to_double(box.lo);
  return side.x * side.y + side.y * side.z + side.z * side.x;
}

// A triangle by its longest side, from a to b: across it, at a share in [0, 1] of its length, the triangle reaches from
// the side to the line over the third corner, which lies at `top`.
struct Needle {
  Vec3d a, b, c;
  double top = 0;

  explicit Needle(const Corners& t) {
    std::size_t longest = 0;
    const auto side = [&](std::size_t k) { return t[(k + 1) % 3] - t[k]; };
    for (std::size_t k = 1; k < 3; ++k)
      if (dot(side(k), side(k)) > dot(side(longest), side(longest))) longest = k;
    a = t[longest], b = t[(longest + 1) % 3], c = t[(longest + 2) % 3];
    const double length2 = dot(b - a, b - a);
    top = length2 > 0 ? std::clamp(dot(c - a, b - a) / length2, 0.0, 1.0) : 0;
  }
  // Box of the part between two shares, to within rounding in double precision.
  [[nodiscard]] Box3f box(double first, double last) const {
    Box3f box;
    for (const double share : {first, last}) {
      extend(box, a + share * (b - a));
      extend(box, share < top ? a + (share / top) * (c - a) : top < 1 ? b + ((1 - share) / (1 - top)) * (c - b) : c);
    }
    if (first < top && top < last) extend(box, c);
    return box;
  }
};

struct Part {
  double area = 0;             // half of the surface of the box
  std::size_t item = 0;        // among the items
  std::uint32_t triangle = 0;  // among the triangles
  double first = 0, last = 1;  // along its longest side
  friend bool operator<(const Part& a, const Part& b) { return a.area != b.area ? a.area < b.area : a.item > b.item; }
};

}  // namespace

void divide_boxes(std::vector<BoxTree::Item>& items, std::size_t count, const CornersOf& corners_of, std::size_t most) {
  Box3f whole;
  for (const BoxTree::Item& item : items) whole.extend(item.box);
  const double share = over_share * half_area(whole) / static_cast<double>(std::max<std::size_t>(count, 1));
  std::priority_queue<Part> large;
  const auto add = [&](const Part& part) {
    if (!(part.area > share)) return;
    const Corners t = corners_of(part.triangle);
    const double area = 0.5 * length(cross(t[1] - t[0], t[2] - t[0])) * (part.last - part.first);
    if (part.area > over_triangle * area) large.push(part);
  };
  for (std::uint32_t i = 0; i < count; ++i) add({half_area(items[i].box), i, i});
  for (std::size_t added = 0; added < most && !large.empty();) {
    const Part part = large.top();
    large.pop();
    const Needle needle(corners_of(part.triangle));
    const double middle = 0.5 * (part.first + part.last);
    const Box3f one = needle.box(part.first, middle), other = needle.box(middle, part.last);
    if (half_area(one) + half_area(other) > worthwhile * part.area) continue;
    const std::uint32_t number = items[part.item].number;
    items[part.item].box = one;
    items.push_back({other, number});
    ++added;
    add({half_area(one), part.item, part.triangle, part.first, middle});
    add({half_area(other), items.size() - 1, part.triangle, middle, part.last});
  }
}

}  // namespace lodestone
