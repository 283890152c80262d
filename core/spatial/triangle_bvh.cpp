#include "core/spatial/triangle_bvh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

namespace lodestone {
namespace {

constexpr std::uint32_t leaf_bit = 0x8000'0000u;
constexpr std::uint32_t leaf_triangles = 4;

constexpr std::uint32_t leaf_of(std::uint32_t first, std::uint32_t count) {
  return leaf_bit | first << 2 | (count - 1);
}
constexpr std::uint32_t leaf_first(std::uint32_t leaf) { return (leaf & ~leaf_bit) >> 2; }
constexpr std::uint32_t leaf_count(std::uint32_t leaf) { return (leaf & 3) + 1; }

constexpr float infinity = std::numeric_limits<float>::infinity();

float round_down(double v) {
  const auto f = static_cast<float>(v);
  return f > v ? std::nextafter(f, -infinity) : f;
}

float round_up(double v) {
  const auto f = static_cast<float>(v);
  return f < v ? std::nextafter(f, infinity) : f;
}

void extend(Box3f& box, Vec3d p) {
  box.extend(Vec3f{round_down(p.x), round_down(p.y), round_down(p.z)});
  box.extend(Vec3f{round_up(p.x), round_up(p.y), round_up(p.z)});
}

double squared_distance(Vec3d p, const Box3f& box) {
  const auto outside = [](double lo, double hi, double v) { return std::max(std::max(lo - v, v - hi), 0.0); };
  const double x = outside(box.lo.x, box.hi.x, p.x), y = outside(box.lo.y, box.hi.y, p.y),
               z = outside(box.lo.z, box.hi.z, p.z);
  return (x * x + y * y) + z * z;
}

// From which t >= least on the ray is in the box, if it ever is; `inverse`: of its direction, finite.
bool enters_box(const Box3f& box, Vec3d from, Vec3d inverse, double least, double& enter) {
  double leave = infinity;
  enter = least;
  const auto clip = [&](double lo, double hi, double origin, double scale) {
    const double a = (lo - origin) * scale, b = (hi - origin) * scale;
    enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
  };
  clip(box.lo.x, box.hi.x, from.x, inverse.x);
  clip(box.lo.y, box.hi.y, from.y, inverse.y);
  clip(box.lo.z, box.hi.z, from.z, inverse.z);
  return enter <= leave * (1 + 1e-12);
}

// As in moeller1997, both sides; infinity without a point in common.
double meet_triangle(Vec3d from, Vec3d direction, double least, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d ab = b - a, ac = c - a, p = cross(direction, ac);
  const double det = dot(ab, p);
  if (det == 0) return infinity;
  const Vec3d ap = from - a, q = cross(ap, ab);
  const double u = dot(ap, p) / det, v = dot(direction, q) / det, t = dot(ac, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && t >= least ? t : double{infinity};
}

// Spreads the low 21 bits of v to every third bit.
std::uint64_t spread21(std::uint64_t v) {
  v = (v | v << 32) & 0x001f'0000'0000'ffffull;
  v = (v | v << 16) & 0x001f'0000'ff00'00ffull;
  v = (v | v << 8) & 0x100f'00f0'0f00'f00full;
  v = (v | v << 4) & 0x10c3'0c30'c30c'30c3ull;
  return (v | v << 2) & 0x1249'2492'4924'9249ull;
}

// Morton codes of the triangles' centres (twice the centre of the box) on a lattice over all of them.
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
  [[nodiscard]] std::uint64_t code(Vec3d a, Vec3d b, Vec3d c) const {
    const auto slot = [&](double u, double v, double w, double lo) {
      const double twice = std::min({u, v, w}) + std::max({u, v, w}) - 2 * lo;
      return spread21(static_cast<std::uint64_t>(std::clamp(0.5 * twice * scale_, 0.0, last)));
    };
    return slot(a.x, b.x, c.x, lo_.x) | slot(a.y, b.y, c.y, lo_.y) << 1 | slot(a.z, b.z, c.z, lo_.z) << 2;
  }

 private:
  static constexpr double last = (1u << 21) - 1;
  Vec3d lo_, hi_;
  double scale_ = 0;
};

}  // namespace

TriangleBvh::TriangleBvh(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  assert(!triangles.empty() && triangles.size() <= (1u << 29));
  const CentreLattice lattice(positions);
  std::vector<Key> keys(triangles.size());
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    const auto& v = triangles[i].v;
    keys[i] = {lattice.code(positions[v[0]], positions[v[1]], positions[v[2]]), i};
  }
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
    return a.morton != b.morton ? a.morton < b.morton : a.triangle < b.triangle;
  });

  constexpr std::uint32_t unseen = 0xffff'ffffu;
  std::vector<std::uint32_t> renumbered(positions.size(), unseen);
  slots_.reserve(keys.size());
  original_.reserve(keys.size());
  for (const Key& key : keys) {
    Triangle slot;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t v = triangles[key.triangle].v[i];
      if (renumbered[v] == unseen) {
        renumbered[v] = static_cast<std::uint32_t>(positions_.size());
        positions_.push_back(positions[v]);
      }
      slot.v[i] = renumbered[v];
    }
    slots_.push_back(slot);
    original_.push_back(key.triangle);
  }
  nodes_.reserve(keys.size() / 2);
  root_ = build(keys, 0, static_cast<std::uint32_t>(keys.size()));
}

// Depth is at most 63 splits between different codes and 32 between equal ones.
TriangleBvh::Subtree TriangleBvh::build(std::span<const Key> keys, std::uint32_t first, std::uint32_t end) {
  if (end - first <= leaf_triangles) {
    Subtree leaf{{}, leaf_of(first, end - first)};
    for (std::uint32_t slot = first; slot < end; ++slot)
      for (const std::uint32_t v : slots_[slot].v) extend(leaf.box, positions_[v]);
    return leaf;
  }
  std::uint32_t middle = first + (end - first) / 2;
  if (const std::uint64_t differing = keys[first].morton ^ keys[end - 1].morton; differing != 0) {
    const std::uint64_t bit = std::bit_floor(differing);
    const auto range = keys.subspan(first, end - first);
    middle = first + static_cast<std::uint32_t>(std::partition_point(range.begin(), range.end(),
                                                                     [&](const Key& k) { return !(k.morton & bit); }) -
                                                range.begin());
  }
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  const Subtree left = build(keys, first, middle), right = build(keys, middle, end);
  nodes_[number] = {{left.box, right.box}, {left.child, right.child}};
  Subtree result{left.box, number};
  result.box.extend(right.box);
  return result;
}

void TriangleBvh::take_slot(std::uint32_t slot, Vec3d p, Nearest& best) const {
  const auto& v = slots_[slot].v;
  const NearestPoint found = nearest_on_triangle(p, positions_[v[0]], positions_[v[1]], positions_[v[2]]);
  if (found.squared_distance < best.squared_distance) best = {found.point, found.squared_distance, slot};
}

void TriangleBvh::take_leaf(std::uint32_t leaf, Vec3d p, Nearest& best) const {
  const std::uint32_t first = leaf_first(leaf);
  for (std::uint32_t slot = first; slot < first + leaf_count(leaf); ++slot) take_slot(slot, p, best);
}

TriangleBvh::Nearest TriangleBvh::nearest(Vec3d p, std::uint32_t hint) const {
  struct Waiting {
    double squared_distance;
    std::uint32_t child;
  };
  std::array<Waiting, 128> stack;
  std::size_t size = 0;
  Nearest best{{}, std::numeric_limits<double>::infinity(), 0};
  if (hint != no_hint) take_slot(hint, p, best);

  std::uint32_t at = root_.child;
  for (;;) {
    if (at & leaf_bit) {
      take_leaf(at, p, best);
    } else {
      const Node& node = nodes_[at];
      const double d[2] = {squared_distance(p, node.box[0]), squared_distance(p, node.box[1])};
      const int near = d[1] < d[0];
      if (d[1 - near] < best.squared_distance) stack[size++] = {d[1 - near], node.child[1 - near]};
      if (d[near] < best.squared_distance) {
        at = node.child[near];
        continue;
      }
    }
    do {
      if (size == 0) return best;
      at = stack[--size].child;
    } while (!(stack[size].squared_distance < best.squared_distance));
  }
}

double TriangleBvh::meet_leaf(std::uint32_t leaf, Vec3d from, Vec3d direction, double least) const {
  const std::uint32_t first = leaf_first(leaf);
  double nearest = infinity;
  for (std::uint32_t slot = first; slot < first + leaf_count(leaf); ++slot) {
    const auto& v = slots_[slot].v;
    nearest =
        std::min(nearest, meet_triangle(from, direction, least, positions_[v[0]], positions_[v[1]], positions_[v[2]]));
  }
  return nearest;
}

double TriangleBvh::meet(Vec3d from, Vec3d direction, double least, Hit hit) const {
  const auto inverse_of = [](double v) { return 1 / (v == 0 ? 1e-300 : v); };
  const Vec3d inverse{inverse_of(direction.x), inverse_of(direction.y), inverse_of(direction.z)};
  std::array<std::uint32_t, 128> stack;
  std::size_t size = 0;
  stack[size++] = root_.child;
  double nearest = infinity;
  while (size > 0 && (hit == Hit::first || nearest == infinity)) {
    const std::uint32_t at = stack[--size];
    if (at & leaf_bit) {
      nearest = std::min(nearest, meet_leaf(at, from, direction, least));
      continue;
    }
    const Node& node = nodes_[at];
    for (std::size_t k = 0; k < 2; ++k)
      if (double enter = 0; enters_box(node.box[k], from, inverse, least, enter) && enter <= nearest * (1 + 1e-12))
        stack[size++] = node.child[k];
  }
  return nearest;
}

}  // namespace lodestone
