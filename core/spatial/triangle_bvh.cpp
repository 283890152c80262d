#include "core/spatial/triangle_bvh.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "core/spatial/part_boxes.h"

namespace lodestone {
namespace {

// Long triangles that cross each other's boxes: as many parts as memory allows. Where they lie side by side, a few
// parts and slabs do.
constexpr std::size_t parts_per_triangle = 12, parts_with_slabs = 2;

// Squared distance of what coincides but for the rounding of coordinates near 1. Where thousands of triangles cover a
// point, all of them would be searched for a smaller one.
constexpr double rounding2 = 1e-31;

constexpr double infinity = std::numeric_limits<double>::infinity();

// The parameter of the intersection as in moeller1997, both sides; infinity if there is none.
double meet_triangle(Vec3d from, Vec3d direction, double least, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d ab = b - a, ac = c - a, p = cross(direction, ac);
  const double det = dot(ab, p);
  if (det == 0) return infinity;
  const Vec3d ap = from - a, q = cross(ap, ab);
  const double u = dot(ap, p) / det, v = dot(direction, q) / det, t = dot(ac, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && t >= least ? t : infinity;
}

// Spreads the low 21 bits of v to every third bit.
std::uint64_t spread21(std::uint64_t v) {
  v = (v | v << 32) & 0x001f'0000'0000'ffffull;
  v = (v | v << 16) & 0x001f'0000'ff00'00ffull;
  v = (v | v << 8) & 0x100f'00f0'0f00'f00full;
  v = (v | v << 4) & 0x10c3'0c30'c30c'30c3ull;
  return (v | v << 2) & 0x1249'2492'4924'9249ull;
}

// Morton codes of the centres of boxes on a lattice over all positions.
class CentreLattice {
 public:
  explicit CentreLattice(std::span<const Vec3d> positions) {
    lo_ = hi_ = positions.front();
    for (const Vec3d p : positions) {
      lo_ = {std::min(lo_.x, p.x), std::min(lo_.y, p.y), std::min(lo_.z, p.z)};
      hi_ = {std::max(hi_.x, p.x), std::max(hi_.y, p.y), std::max(hi_.z, p.z)};
    }
    const double extent = std::max({hi_.x - lo_.x, hi_.y - lo_.y, hi_.z - lo_.z});
    scale_ = extent > 0 ? last / extent : 0;
  }
  [[nodiscard]] std::uint64_t code(const Box3f& box) const {
    const auto slot = [&](double a, double b, double lo) {
      return spread21(static_cast<std::uint64_t>(std::clamp(0.5 * (a + b - 2 * lo) * scale_, 0.0, last)));
    };
    return slot(box.lo.x, box.hi.x, lo_.x) | slot(box.lo.y, box.hi.y, lo_.y) << 1 |
           slot(box.lo.z, box.hi.z, lo_.z) << 2;
  }

 private:
  static constexpr double last = (1u << 21) - 1;
  Vec3d lo_, hi_;
  double scale_ = 0;
};

using Corners = std::array<Vec3d, 3>;

// Boxes of triangles and of parts of them, and their Morton order.
struct Parts {
  std::vector<BoxTree::Item> items;  // of each triangle, by its number, then more
  std::vector<BoxTree::Code> codes;  // by slot

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(codes.size()); }
  [[nodiscard]] std::uint32_t number(std::uint32_t slot) const { return items[codes[slot].number].number; }
};

Parts make_parts(std::size_t count, const CornersOf& corners_of, std::size_t per_triangle,
                 const CentreLattice& lattice) {
  Parts parts{std::vector<BoxTree::Item>(count), {}};
  for (std::uint32_t i = 0; i < count; ++i) {
    parts.items[i].number = i;
    for (const Vec3d p : corners_of(i)) extend(parts.items[i].box, p);
  }
  divide_boxes(parts.items, count, corners_of, per_triangle * count);
  parts.codes.resize(parts.items.size());
  for (std::uint32_t i = 0; i < parts.codes.size(); ++i) parts.codes[i] = {lattice.code(parts.items[i].box), i};
  std::sort(parts.codes.begin(), parts.codes.end(), [](const BoxTree::Code& a, const BoxTree::Code& b) {
    return a.morton != b.morton ? a.morton < b.morton : a.number < b.number;
  });
  return parts;
}

}  // namespace

TriangleBvh::TriangleBvh(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  assert(!triangles.empty());
  // From the arguments whenever they are asked for: an array of all would be the largest here.
  const auto corners = [&](std::uint32_t triangle) {
    const auto& v = triangles[triangle].v;
    return Corners{positions[v[0]], positions[v[1]], positions[v[2]]};
  };
  const CentreLattice lattice(positions);
  Parts parts = make_parts(triangles.size(), corners, parts_with_slabs, lattice);
  const auto corners_of = [&](std::uint32_t slot) { return corners(parts.number(slot)); };
  bool with_slabs = false;
  if (parts.items.size() == (1 + parts_with_slabs) * triangles.size()) {
    with_slabs = are_side_by_side(parts.size(), corners_of);
    if (!with_slabs) parts = make_parts(triangles.size(), corners, parts_per_triangle, lattice);
  }

  std::vector<std::uint32_t> renumbered(positions.size(), no_hint);
  slots_.reserve(parts.size());
  triangle_of_.reserve(parts.size());
  for (std::uint32_t slot = 0; slot < parts.size(); ++slot) {
    triangle_of_.push_back(parts.number(slot));
    add_slot(triangles[parts.number(slot)], positions, renumbered);
  }
  tree_ = BoxTree(parts.codes, [&](std::uint32_t slot) { return parts.items[parts.codes[slot].number].box; });
  if (with_slabs) tree_.add_slabs(corners_of);
}

// Vertices get the order in which slots first use them: those of a leaf are close together in memory.
void TriangleBvh::add_slot(const Triangle& triangle, std::span<const Vec3d> positions,
                           std::vector<std::uint32_t>& renumbered) {
  Triangle slot;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t v = triangle.v[i];
    if (renumbered[v] == no_hint) {
      renumbered[v] = static_cast<std::uint32_t>(positions_.size());
      positions_.push_back(positions[v]);
    }
    slot.v[i] = renumbered[v];
  }
  slots_.push_back(slot);
}

void TriangleBvh::take_slot(std::uint32_t slot, Vec3d p, Nearest& best) const {
  const auto& v = slots_[slot].v;
  const NearestPoint found = nearest_on_triangle(p, positions_[v[0]], positions_[v[1]], positions_[v[2]]);
  if (found.squared_distance < best.squared_distance) best = {found.point, found.squared_distance, slot};
}

TriangleBvh::Nearest TriangleBvh::nearest(Vec3d p, std::uint32_t hint) const {
  Nearest best{{}, infinity, 0};
  if (hint != no_hint) take_slot(hint, p, best);
  if (best.squared_distance <= rounding2) return best;
  tree_.search(p, best.squared_distance, [&](BoxTree::Slots slots) {
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) take_slot(slot, p, best);
    return best.squared_distance <= rounding2;
  });
  return best;
}

double TriangleBvh::meet(Vec3d from, Vec3d direction, double least, Hit hit) const {
  constexpr double rounding = 1 + 1e-12;
  const BoxLine line(from, direction);
  double nearest = infinity;
  const auto accepts = [&](const Box3f& box) {
    const auto [enter, leave] = line.clip(box, 0, least, infinity);
    return enter <= leave * rounding && enter <= nearest * rounding;
  };
  tree_.walk(accepts, [&](BoxTree::Slots slots) {
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) {
      const auto& v = slots_[slot].v;
      nearest = std::min(nearest,
                         meet_triangle(from, direction, least, positions_[v[0]], positions_[v[1]], positions_[v[2]]));
    }
    return hit == Hit::any_will_do && nearest < infinity;
  });
  return nearest;
}

}  // namespace lodestone
