// The arcs lie in the planes x = 0 and y = 0, so that the sign of a coordinate is an exact predicate. The sign of a
// difference of two rounded products is the exact one or zero, because rounding is monotone: "zero" is taken as "on the
// edge" by both triangles at it.
#include "core/spherical/octahedron/unfold.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/base/error.h"
#include "core/spherical/octahedron/rough_square.h"

namespace lodestone::spherical {
namespace {

constexpr std::array<Vec3d, 5> ends{{{0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}}};

int sign(double v) { return (v > 0) - (v < 0); }

// The sign of p . (a x b) for a unit vector p along an axis.
int side_of(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d normal = cross(a, b);
  return sign(p.x != 0 ? p.x * normal.x : p.y != 0 ? p.y * normal.y : p.z * normal.z);
}

// `copy` as in Quarters below.
Octant octant_of_copy(Vec3d d, std::uint32_t copy) {
  return {d.x < 0 || (copy & 1u) != 0 ? -1.0 : 1.0, d.y < 0 || (copy & 2u) != 0 ? -1.0 : 1.0, d.z < 0 ? -1.0 : 1.0};
}
SquarePoint place_of(Vec3d d, std::uint32_t copy) { return square_point(d, octant_of_copy(d, copy)); }

class Cutter {
 public:
  Cutter(std::span<const Triangle> triangles, std::span<const Vec3d> directions) : input_(directions.size()) {
    out_.directions.assign(directions.begin(), directions.end());
    out_.triangles.assign(triangles.begin(), triangles.end());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) out_.source.push_back(t);
  }

  // Makes p a vertex.
  void insert(Vec3d p);
  // Splits all edges that the two arcs in the plane where the coordinate is zero cross.
  void split_along(double Vec3d::*coordinate);
  // Halves edges until none is bent by more than this, or a quarter of the triangles has been added.
  void split_bent(double most_bend);
  [[nodiscard]] Unfolding take();

 private:
  // A direction as a combination of directions of the input.
  struct Support {
    std::array<std::uint32_t, 3> corner{};
    std::array<double, 3> weight{};
  };
  [[nodiscard]] Support support(std::uint32_t vertex) const {
    return vertex < input_ ? Support{{vertex, vertex, vertex}, {1, 0, 0}} : supports_[vertex - input_];
  }
  struct Share {
    std::uint32_t vertex = 0;
    double weight = 0;
  };
  std::uint32_t add(Vec3d direction, std::span<const Share> of);
  void replace(std::uint32_t triangle, std::span<const Triangle> parts);
  bool insert_into(std::uint32_t triangle, Vec3d p);
  void split_edge(std::uint32_t a, std::uint32_t b, Vec3d p);
  std::optional<std::uint32_t> middle_of(std::uint32_t a, std::uint32_t b, double Vec3d::*coordinate);
  template <class PointOf>
  [[nodiscard]] double bend(std::uint32_t a, std::uint32_t b, const PointOf& point_of) const;
  [[nodiscard]] bool is_bent(std::uint32_t a, std::uint32_t b, double most_bend) const;
  std::optional<std::uint32_t> middle_of_bent(std::uint32_t a, std::uint32_t b, double most_bend);
  template <class MiddleOf>
  bool split_all(const MiddleOf& middle_of);  // true if any edge was split
  void split(std::uint32_t triangle, const std::array<std::optional<std::uint32_t>, 3>& middles);

  std::size_t input_;
  std::vector<Support> supports_;                             // by added vertex
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;  // by edge, lower vertex in the upper half
  Unfolding out_;
};

// `direction` is along the weighted sum of the directions.
std::uint32_t Cutter::add(Vec3d direction, std::span<const Share> of) {
  Support sum;
  std::size_t used = 0;
  Vec3d along{};
  for (const Share& share : of) {
    const Support part = support(share.vertex);
    along = along + share.weight * out_.directions[share.vertex];
    for (std::size_t k = 0; k < 3; ++k) {
      if (part.weight[k] == 0) continue;
      const auto end = sum.corner.begin() + static_cast<std::ptrdiff_t>(used);
      const auto at = static_cast<std::size_t>(std::find(sum.corner.begin(), end, part.corner[k]) - sum.corner.begin());
      if (at == used) sum.corner[used++] = part.corner[k];
      sum.weight[at] += share.weight * part.weight[k];
    }
  }
  for (std::size_t k = used; k < 3; ++k) sum.corner[k] = sum.corner[0];
  const double scale = 1 / length(along);
  for (double& weight : sum.weight) weight *= scale;
  supports_.push_back(sum);
  out_.directions.push_back(direction);
  return static_cast<std::uint32_t>(out_.directions.size() - 1);
}

void Cutter::replace(std::uint32_t triangle, std::span<const Triangle> parts) {
  out_.triangles[triangle] = parts.front();
  for (const Triangle& part : parts.subspan(1)) {
    out_.triangles.push_back(part);
    out_.source.push_back(out_.source[triangle]);
  }
}

void Cutter::insert(Vec3d p) {
  // Triangles that contain p; those that the insertion appends do not.
  bool found = false;
  const auto count = static_cast<std::uint32_t>(out_.triangles.size());
  for (std::uint32_t t = 0; t < count; ++t) found |= insert_into(t, p);
  if (!found)
    throw InputError(describe("", "sphere map", "no triangle covers an end of the cut",
                              "give a closed mesh whose map covers the sphere"));
}

bool Cutter::insert_into(std::uint32_t triangle, Vec3d p) {
  const std::array<std::uint32_t, 3> v = out_.triangles[triangle].v;
  std::array<int, 3> sides{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d d = out_.directions[v[k]];
    if (d == p) return true;
    sides[k] = side_of(p, d, out_.directions[v[(k + 1) % 3]]);
  }
  if (std::ranges::min(sides) < 0 || std::ranges::max(sides) == 0) return false;
  const auto zeros = std::ranges::count(sides, 0);
  if (zeros == 2) {  // p lies at the corner that both edges share
    const auto edge = static_cast<std::size_t>(std::ranges::max_element(sides) - sides.begin());
    out_.directions[v[(edge + 2) % 3]] = p;
    return true;
  }
  if (zeros == 1) {
    const auto edge = static_cast<std::size_t>(std::ranges::find(sides, 0) - sides.begin());
    split_edge(v[edge], v[(edge + 1) % 3], p);
    return true;
  }
  const auto weight = [&](std::size_t k) {
    return dot(p, cross(out_.directions[v[(k + 1) % 3]], out_.directions[v[(k + 2) % 3]]));
  };
  const std::array<Share, 3> shares{Share{v[0], weight(0)}, Share{v[1], weight(1)}, Share{v[2], weight(2)}};
  const std::uint32_t m = add(p, shares);
  replace(triangle, std::array<Triangle, 3>{Triangle{{v[0], v[1], m}}, {{v[1], v[2], m}}, {{v[2], v[0], m}}});
  return true;
}

// p is on the edge.
void Cutter::split_edge(std::uint32_t a, std::uint32_t b, Vec3d p) {
  const Vec3d from = out_.directions[a], to = out_.directions[b];
  const std::array<Share, 2> shares{Share{a, length(cross(p, to))}, Share{b, length(cross(from, p))}};
  const std::uint32_t m = add(p, shares);
  const auto count = static_cast<std::uint32_t>(out_.triangles.size());
  for (std::uint32_t t = 0; t < count; ++t) {
    const std::array<std::uint32_t, 3>& v = out_.triangles[t].v;
    std::array<std::optional<std::uint32_t>, 3> middles;
    for (std::size_t k = 0; k < 3; ++k)
      if (std::minmax(v[k], v[(k + 1) % 3]) == std::minmax(a, b)) middles[k] = m;
    split(t, middles);
  }
}

// The new vertex of an edge that crosses the plane below the equator; none for others.
std::optional<std::uint32_t> Cutter::middle_of(std::uint32_t a, std::uint32_t b, double Vec3d::*coordinate) {
  if (a > b) std::swap(a, b);
  const Vec3d from = out_.directions[a], to = out_.directions[b];
  const double x = from.*coordinate, y = to.*coordinate;
  if (!((x < 0 && y > 0) || (x > 0 && y < 0))) return std::nullopt;
  const double down = x > 0 ? x * to.z - y * from.z : y * from.z - x * to.z;
  if (!(down < 0)) return std::nullopt;
  const std::uint64_t edge = std::uint64_t{a} << 32 | b;
  if (const auto known = middles_.find(edge); known != middles_.end()) return known->second;
  const std::array<Share, 2> shares{Share{a, std::abs(y)}, Share{b, std::abs(x)}};
  Vec3d p = std::abs(y) * from + std::abs(x) * to;
  p.*coordinate = 0;
  const std::uint32_t m = add((1 / length(p)) * p, shares);
  middles_.emplace(edge, m);
  return m;
}

// The distance in the square between the middle of an edge as it is drawn and as the image has it; the same for both
// triangles at the edge, and for both copies of one on the cut.
template <class PointOf>
double Cutter::bend(std::uint32_t a, std::uint32_t b, const PointOf& point_of) const {
  const Vec3d from = out_.directions[a], to = out_.directions[b], middle = from + to;
  const auto place = [&](Vec3d d) {
    return point_of(d, octant_of_copy(d, (d.x == 0 && middle.x < 0 ? 1u : 0u) | (d.y == 0 && middle.y < 0 ? 2u : 0u)));
  };
  const SquarePoint p = place(from), q = place(to), m = place((1 / length(middle)) * middle);
  return std::hypot(m.s - (p.s + q.s) / 2, m.t - (p.t + q.t) / 2);
}

bool Cutter::is_bent(std::uint32_t a, std::uint32_t b, double most_bend) const {
  constexpr double error = 3 * rough_square_error;  // two coordinates, of the middle and of the mean of the ends
  if (bend(a, b, rough_square_point) <= most_bend - error) return false;
  return bend(a, b, [](Vec3d d, const Octant& octant) { return square_point(d, octant); }) > most_bend;
}

std::optional<std::uint32_t> Cutter::middle_of_bent(std::uint32_t a, std::uint32_t b, double most_bend) {
  if (a > b) std::swap(a, b);
  const Vec3d from = out_.directions[a], to = out_.directions[b];
  if (squared_length(from - to) < 4 * most_bend * most_bend) return std::nullopt;  // its places are nearer than that
  const std::uint64_t edge = std::uint64_t{a} << 32 | b;
  if (const auto known = middles_.find(edge); known != middles_.end()) return known->second;
  if (!is_bent(a, b, most_bend)) return std::nullopt;
  const std::array<Share, 2> shares{Share{a, 0.5}, Share{b, 0.5}};
  const std::uint32_t m = add((1 / length(from + to)) * (from + to), shares);
  middles_.emplace(edge, m);
  return m;
}

template <class MiddleOf>
bool Cutter::split_all(const MiddleOf& middle_of) {
  middles_.clear();
  const auto count = static_cast<std::uint32_t>(out_.triangles.size());
  for (std::uint32_t t = 0; t < count; ++t) {
    const std::array<std::uint32_t, 3>& v = out_.triangles[t].v;
    std::array<std::optional<std::uint32_t>, 3> middles;
    for (std::size_t k = 0; k < 3; ++k) middles[k] = middle_of(v[k], v[(k + 1) % 3]);
    split(t, middles);
  }
  return !middles_.empty();
}

void Cutter::split_along(double Vec3d::*coordinate) {
  split_all([&](std::uint32_t a, std::uint32_t b) { return middle_of(a, b, coordinate); });
}

// The worst first: what is left out where many are bent is small.
void Cutter::split_bent(double most_bend) {
  const std::size_t most_triangles = out_.triangles.size() + out_.triangles.size() / 4 + 256;
  for (double bend = 0.25; bend >= most_bend; bend /= 2)
    while (out_.triangles.size() < most_triangles &&
           split_all([&](std::uint32_t a, std::uint32_t b) { return middle_of_bent(a, b, bend); })) {
    }
}

// middles[k] is on the edge from corner k to the next.
void Cutter::split(std::uint32_t triangle, const std::array<std::optional<std::uint32_t>, 3>& middles) {
  const std::array<std::uint32_t, 3> v = out_.triangles[triangle].v;
  if (middles[0] && middles[1] && middles[2]) {
    const std::uint32_t m = *middles[0], n = *middles[1], o = *middles[2];
    return replace(triangle,
                   std::array<Triangle, 4>{Triangle{{m, n, o}}, {{v[0], m, o}}, {{v[1], n, m}}, {{v[2], o, n}}});
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    if (!middles[k] || middles[next]) continue;
    const std::uint32_t m = *middles[k], a = v[k], b = v[next], c = v[last];
    if (!middles[last]) return replace(triangle, std::array<Triangle, 2>{Triangle{{a, m, c}}, {{m, b, c}}});
    // Corner a is cut off; the rest is divided by its shorter diagonal.
    const std::uint32_t n = *middles[last];
    const auto distance = [&](std::uint32_t i, std::uint32_t j) {
      return length(out_.directions[i] - out_.directions[j]);
    };
    if (distance(m, c) < distance(b, n))
      return replace(triangle, std::array<Triangle, 3>{Triangle{{a, m, n}}, {{m, b, c}}, {{m, c, n}}});
    return replace(triangle, std::array<Triangle, 3>{Triangle{{a, m, n}}, {{m, b, n}}, {{b, c, n}}});
  }
}

// The copies of a vertex, named by the quarter of the square that a triangle lies in: bit 0 for x < 0, bit 1 for y < 0.
// Vertices that are not on the cut have one copy, named 0.
struct Quarters {
  std::array<bool, 2> negative{};

  Quarters(const Triangle& triangle, std::span<const Vec3d> directions) {
    Vec3d sum{};
    for (const std::uint32_t v : triangle.v) sum = sum + directions[v];
    negative = {sum.x < 0, sum.y < 0};
  }
  [[nodiscard]] std::uint32_t copy(Vec3d d) const {
    if (!(d.z < 0)) return 0;
    return (d.x == 0 && negative[0] ? 1u : 0u) | (d.y == 0 && negative[1] ? 2u : 0u);
  }
};

void make_wedges(Unfolding& out) {
  std::vector<std::uint8_t> copies(out.directions.size());  // bits of the copies that triangles use
  for (const Triangle& triangle : out.triangles) {
    const Quarters quarters(triangle, out.directions);
    for (const std::uint32_t v : triangle.v)
      copies[v] = static_cast<std::uint8_t>(copies[v] | 1u << quarters.copy(out.directions[v]));
  }
  std::vector<std::uint32_t> first;
  first.reserve(copies.size());
  for (std::uint32_t v = 0; v < copies.size(); ++v) {
    const auto begin = static_cast<std::uint32_t>(out.vertex.size());
    first.push_back(begin);
    for (std::uint32_t copy = 0; copy < 4; ++copy) {
      if ((copies[v] >> copy & 1u) == 0) continue;
      out.vertex.push_back(v);
      out.place.push_back(place_of(out.directions[v], copy));
    }
    if (const auto count = static_cast<std::uint32_t>(out.vertex.size()) - begin; count > 1)
      out.cut.push_back({v, begin, count});
  }
  for (const Triangle& triangle : out.triangles) {
    const Quarters quarters(triangle, out.directions);
    Triangle& corners = out.corners.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangle.v[k], below = (1u << quarters.copy(out.directions[v])) - 1;
      corners.v[k] = first[v] + static_cast<std::uint32_t>(std::popcount(copies[v] & below));
    }
  }
}

Unfolding Cutter::take() {
  for (const Support& support : supports_) {
    const double sum = (support.weight[0] + support.weight[1]) + support.weight[2];
    AddedVertex& added = out_.added.emplace_back(AddedVertex{support.corner, support.weight});
    for (double& weight : added.weight) weight /= sum;
  }
  make_wedges(out_);
  return std::move(out_);
}

}  // namespace

Unfolding unfold(std::span<const Triangle> triangles, std::span<const Vec3d> directions, double most_bend) {
  Cutter cutter(triangles, directions);
  for (const Vec3d end : ends) cutter.insert(end);
  cutter.split_along(&Vec3d::x);
  cutter.split_along(&Vec3d::y);
  cutter.split_bent(most_bend);
  return cutter.take();
}

}  // namespace lodestone::spherical
