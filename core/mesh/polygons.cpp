#include "core/mesh/polygons.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/math/orientation.h"

namespace lodestone {
namespace {

constexpr std::uint32_t no_corner = 0xFFFF'FFFFu;

// A power of two that brings coordinates into the range of exact signs; 0 if there is none.
double scale_of(std::span<const Vec3d> polygon) {
  double largest = 0;
  for (const Vec3d& p : polygon) {
    if (!is_finite(p)) return 0;
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  if (largest == 0 || (largest > 0x1p-100 && largest < 0x1p100)) return 1;
  return std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1000, 1000));
}

// Twice the area by axis (Newell's sum), seen from corner 0 so that an offset does no harm.
std::array<double, 3> area_by_axis(std::span<const Vec3d> polygon, double scale) {
  Vec3d sum;
  Vec3d edge = scale * polygon[1] - scale * polygon[0];
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Vec3d next = scale * polygon[k] - scale * polygon[0];
    sum = sum + cross(edge, next);
    edge = next;
  }
  return {sum.x, sum.y, sum.z};
}

// The polygon along the axis that sees most of it, turned counter-clockwise. Coordinates are copied or scaled by a
// power of two, so that what is on a line remains there. False if it has no area.
bool project(std::span<const Vec3d> polygon, std::vector<Vec2d>& plane) {
  const double scale = scale_of(polygon);
  if (scale == 0) return false;
  const std::array<double, 3> area = area_by_axis(polygon, scale);
  const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto axis = std::max_element(area.begin(), area.end(), smaller) - area.begin();
  if (area[static_cast<std::size_t>(axis)] == 0) return false;
  const double x_scale = area[static_cast<std::size_t>(axis)] > 0 ? scale : -scale;
  plane.resize(polygon.size());
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3d p = polygon[k];
    plane[k] = axis == 0   ? Vec2d{x_scale * p.y, scale * p.z}
               : axis == 1 ? Vec2d{x_scale * p.z, scale * p.x}
                           : Vec2d{x_scale * p.x, scale * p.y};
  }
  return true;
}

bool fan_folds(std::span<const Vec2d> plane) {
  for (std::size_t k = 2; k < plane.size(); ++k)
    if (orientation(plane[0], plane[k - 1], plane[k]) < 0) return true;
  return false;
}

struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void add(double x) { low = std::min(low, x), high = std::max(high, x); }
};

// Points by cells of about one each.
class PointGrid {
 public:
  // Numbers of points in `kept`.
  void fill(std::span<const Vec2d> points, std::span<const std::uint32_t> kept) {
    side_ = static_cast<std::uint32_t>(std::clamp(std::sqrt(static_cast<double>(kept.size())), 1.0, 4096.0));
    x_ = y_ = {};
    for (const Vec2d& p : points) x_.add(p.x), y_.add(p.y);
    ends_.assign(std::size_t{side_} * side_ + 1, 0);
    for (const std::uint32_t k : kept) ++ends_[cell(points[k])];
    for (std::size_t c = 1; c < ends_.size(); ++c) ends_[c] += ends_[c - 1];
    items_.resize(kept.size());
    for (const std::uint32_t k : kept) items_[--ends_[cell(points[k])]] = k;
  }

  // Calls visit(k) for points that may lie in the triangle, until it returns false; the last result.
  template <class Visit>
  [[nodiscard]] bool all_near(const std::array<Vec2d, 3>& triangle, const Visit& visit) const {
    // In units of cells. Rounding is monotone, and so rows are exact; columns have a margin, as cuts are rounded.
    std::array<Vec2d, 3> t;
    Interval rows;
    for (std::size_t k = 0; k < 3; ++k) {
      t[k] = {along(x_, triangle[k].x), along(y_, triangle[k].y)};
      rows.add(t[k].y);
    }
    for (std::uint32_t row = clamped(rows.low); row <= clamped(rows.high); ++row) {
      const Interval columns = within(t, row, row + 1.0);
      const std::size_t first = std::size_t{row} * side_ + clamped(columns.low - 1);
      const std::size_t last = std::size_t{row} * side_ + clamped(columns.high + 1);
      for (std::uint32_t i = ends_[first]; i < ends_[last + 1]; ++i)
        if (!visit(items_[i])) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] double along(const Interval& side, double x) const {
    return side.high > side.low ? (x - side.low) / (side.high - side.low) * side_ : 0;
  }
  [[nodiscard]] std::uint32_t clamped(double x) const {
    return static_cast<std::uint32_t>(std::clamp(x, 0.0, side_ - 1.0));
  }
  [[nodiscard]] std::size_t cell(Vec2d p) const {
    return std::size_t{clamped(along(y_, p.y))} * side_ + clamped(along(x_, p.x));
  }

  // The columns of a triangle between two rows.
  static Interval within(const std::array<Vec2d, 3>& t, double low, double high) {
    Interval columns;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2d a = t[k], b = t[(k + 1) % 3];
      if (std::max(a.y, b.y) < low || std::min(a.y, b.y) > high) continue;
      for (const double y : {std::clamp(a.y, low, high), std::clamp(b.y, low, high)})
        columns.add(a.y == b.y ? a.x : a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
      if (a.y == b.y) columns.add(b.x);
    }
    return columns;
  }

  std::uint32_t side_ = 1;
  Interval x_, y_;
  std::vector<std::uint32_t> ends_, items_;  // by cell: the first of its items
};

// The ring of the corners that are left, and those of them that may be ears. An ear remains one, and any other corner
// becomes one only when its neighbours change: each is tried three times at most.
class EarClipping {
 public:
  void run(std::span<const Vec2d> plane, std::vector<Triangle>& triangles) {
    begin(plane);
    triangles.clear();
    for (; left_ > 3; --left_) clip(next_ear(), triangles);
    triangles.push_back({{before_[at_], at_, after_[at_]}});
  }

 private:
  void begin(std::span<const Vec2d> plane) {
    plane_ = plane;
    left_ = static_cast<std::uint32_t>(plane.size());
    at_ = 0, head_ = 0;
    before_.resize(left_), after_.resize(left_), place_.resize(left_), convex_.resize(left_);
    queue_.clear(), reflex_.clear();
    for (std::uint32_t k = 0; k < left_; ++k) before_[k] = (k + left_ - 1) % left_, after_[k] = (k + 1) % left_;
    for (std::uint32_t k = 0; k < left_; ++k) {
      update(k);
      if (!convex_[k]) reflex_.push_back(k);
    }
    grid_.fill(plane, reflex_);
  }

  [[nodiscard]] int turn(std::uint32_t k) const {
    return orientation(plane_[before_[k]], plane_[k], plane_[after_[k]]);
  }

  // After its neighbours have changed.
  void update(std::uint32_t k) {
    convex_[k] = turn(k) > 0;
    place_[k] = no_corner;
    if (!convex_[k]) return;
    place_[k] = static_cast<std::uint32_t>(queue_.size());
    queue_.push_back(k);
  }

  // In the order of the queue, so that the corners next to an ear come last: triangles become less thin than those of a
  // walk around the ring.
  std::uint32_t next_ear() {
    while (head_ < queue_.size()) {
      const std::uint32_t place = static_cast<std::uint32_t>(head_++), k = queue_[place];
      if (place_[k] == place && is_ear(k)) return k;
    }
    return corner_without_ears();
  }

  // A polygon that crosses itself, or of which spikes are left, has none: one without area, rather one that is convex
  // than one that is not.
  std::uint32_t corner_without_ears() {
    std::uint32_t best = at_;
    for (std::uint32_t tried = 0; tried < left_; ++tried, at_ = after_[at_]) {
      const int sign = turn(at_);
      if (sign == 0) return at_;
      if (sign > 0 && !convex_[best]) best = at_;
    }
    return best;
  }

  // The corner is convex.
  [[nodiscard]] bool is_ear(std::uint32_t k) const {
    return grid_.all_near({plane_[before_[k]], plane_[k], plane_[after_[k]]},
                          [&](std::uint32_t other) { return !blocks(other, k); });
  }

  // If anything enters the triangle of an ear, then a reflex corner lies in it, or on its sides. Corners at the places
  // of its neighbours do not count: what comes from there has another such corner, if it enters. One at the place of
  // the ear counts if what is outside there lies in the triangle.
  [[nodiscard]] bool blocks(std::uint32_t k, std::uint32_t ear) const {
    if (convex_[k] || k == ear || k == before_[ear] || k == after_[ear]) return false;
    const Vec2d a = plane_[before_[ear]], b = plane_[ear], c = plane_[after_[ear]], p = plane_[k];
    if (orientation(a, b, p) < 0 || orientation(b, c, p) < 0 || orientation(c, a, p) < 0) return false;
    if (p == a || p == c) return false;
    if (p != b) return true;
    const Vec2d from = plane_[before_[k]], to = plane_[after_[k]];
    return orientation(a, b, from) > 0 && orientation(b, c, from) >= 0 && orientation(a, b, to) >= 0 &&
           orientation(b, c, to) > 0;
  }

  void clip(std::uint32_t k, std::vector<Triangle>& triangles) {
    const std::uint32_t a = before_[k], c = after_[k];
    triangles.push_back({{a, k, c}});
    after_[a] = c, before_[c] = a;
    convex_[k] = 1;         // no longer blocks
    place_[k] = no_corner;  // nor is an ear
    at_ = c;
    update(a), update(c);
  }

  std::span<const Vec2d> plane_;
  std::uint32_t left_ = 0, at_ = 0;  // corners in the ring, and one of them
  std::vector<std::uint32_t> before_, after_;
  std::vector<std::uint8_t> convex_;          // less than 180 degrees
  std::vector<std::uint32_t> queue_, place_;  // place_: of the latest entry of a corner
  std::size_t head_ = 0;
  std::vector<std::uint32_t> reflex_;
  PointGrid grid_;
};

// Keeps its memory from polygon to polygon.
class Cutter {
 public:
  // Empty if the fan is right.
  std::span<const Triangle> cut(std::span<const Vec3d> polygon) {
    triangles_.clear();
    if (polygon.size() > 3 && project(polygon, plane_) && fan_folds(plane_)) ears_.run(plane_, triangles_);
    return triangles_;
  }

 private:
  std::vector<Vec2d> plane_;
  EarClipping ears_;
  std::vector<Triangle> triangles_;
};

// The corner of a polygon by its fan: a triangle for each but the first two.
std::uint32_t corner_of_fan(std::span<const Triangle> fan, std::size_t k) {
  return k == 0 ? fan[0].v[0] : k == 1 ? fan[0].v[1] : fan[k - 2].v[2];
}

void replace_fan(std::span<Triangle> fan, std::span<const Triangle> cut, std::vector<std::uint32_t>& corners) {
  corners.resize(fan.size() + 2);
  for (std::size_t k = 0; k < corners.size(); ++k) corners[k] = corner_of_fan(fan, k);
  for (std::size_t t = 0; t < fan.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) fan[t].v[k] = corners[cut[t].v[k]];
}

}  // namespace

std::vector<Triangle> cut_polygon(std::span<const Vec3d> polygon) {
  Cutter cutter;
  const std::span<const Triangle> triangles = cutter.cut(polygon);
  return {triangles.begin(), triangles.end()};
}

void cut_fans(std::span<const Vec3d> positions, std::span<const FanRun> runs, std::span<Triangle> triangles,
              std::span<const std::span<Triangle>> values) {
  Cutter cutter;
  std::vector<Vec3d> polygon;
  std::vector<std::uint32_t> corners;
  for (const FanRun& run : runs) {
    const std::size_t size = run.corners - 2;
    for (std::size_t k = 0; k < run.polygons; ++k) {
      const std::size_t first = run.first + k * size;
      const std::span<Triangle> fan = triangles.subspan(first, size);
      polygon.resize(run.corners);
      for (std::size_t c = 0; c < run.corners; ++c) polygon[c] = positions[corner_of_fan(fan, c)];
      const std::span<const Triangle> cut = cutter.cut(polygon);
      if (cut.empty()) continue;
      replace_fan(fan, cut, corners);
      for (const std::span<Triangle> list : values) {
        assert(list.size() == triangles.size());
        replace_fan(list.subspan(first, size), cut, corners);
      }
    }
  }
}

}  // namespace lodestone
