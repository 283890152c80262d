#include "render/reconstruct/finish/label_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "core/base/disjoint_sets.h"
#include "core/mesh/raw_mesh.h"

namespace lodestone {

std::vector<std::uint32_t> label_parts(const IndexedMesh& mesh, double least_share) {
  DisjointSets sets(mesh.positions.size());
  for (std::uint32_t w = 0; w < mesh.wedges.vertex.size(); ++w) sets.unite(w, mesh.wedges.vertex[w]);
  for (const Triangle& t : mesh.triangles) sets.unite(t.v[0], t.v[1]), sets.unite(t.v[1], t.v[2]);

  std::vector<std::uint32_t> size(sets.size(), 0), number(sets.size(), 0);
  for (const Triangle& t : mesh.triangles) ++size[sets.find(t.v[0])];
  const double least = least_share * static_cast<double>(mesh.triangles.size());
  std::uint32_t next = 0;
  bool rest = false;
  for (std::uint32_t v = 0; v < size.size(); ++v) {
    if (size[v] == 0) continue;
    if (static_cast<double>(size[v]) < least)
      rest = true;
    else
      number[v] = ++next;
  }
  if (next + (rest ? 1 : 0) < 2) return {};
  std::vector<std::uint32_t> parts;
  parts.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) parts.push_back(number[sets.find(t.v[0])]);
  return parts;
}

namespace {

// Triangles by the vertices they use, to find the one at a directed edge.
class TrianglesAround {
 public:
  TrianglesAround(std::span<const Triangle> triangles, std::size_t vertices)
      : triangles_(triangles), first_(vertices + 1, 0), corner_(3 * triangles.size()) {
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t.v) ++first_[v + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k) corner_[next[triangles[t].v[k]]++] = 3 * t + k;
  }
  // Corners at `from` whose triangle goes on to `to`. Looks at the triangles of the end that has fewer, so that a fan
  // of any size takes linear time.
  template <class Visit>
  void for_edges(std::uint32_t from, std::uint32_t to, const Visit& visit) const {
    if (count(from) <= count(to)) {
      for (std::uint32_t k = first_[from]; k < first_[from + 1]; ++k)
        if (triangles_[corner_[k] / 3].v[(corner_[k] + 1) % 3] == to) visit(corner_[k]);
    } else {
      for (std::uint32_t k = first_[to]; k < first_[to + 1]; ++k)
        if (const std::uint32_t before = corner_[k] % 3 == 0 ? corner_[k] + 2 : corner_[k] - 1;
            triangles_[before / 3].v[before % 3] == from)
          visit(before);
    }
  }

 private:
  [[nodiscard]] std::uint32_t count(std::uint32_t vertex) const { return first_[vertex + 1] - first_[vertex]; }

  std::span<const Triangle> triangles_;
  std::vector<std::uint32_t> first_, corner_;
};

std::uint32_t after(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

}  // namespace

std::optional<std::size_t> count_handles(const IndexedMesh& mesh) {
  std::vector<Triangle> triangles = mesh.triangles;
  if (!mesh.wedges.vertex.empty())
    for (Triangle& t : triangles)
      for (std::uint32_t& v : t.v) v = mesh.wedges.vertex[v];
  std::erase_if(triangles, [](const Triangle& t) { return is_degenerate(t); });
  const TrianglesAround around(triangles, mesh.positions.size());
  const std::size_t corners = 3 * triangles.size();
  DisjointSets fans(corners), components(corners), loops(corners);
  std::vector<std::uint32_t> border;  // corners from which a border edge leaves
  for (std::uint32_t corner = 0; corner < corners; ++corner) {
    const std::uint32_t end = after(corner), from = triangles[corner / 3].v[corner % 3],
                        to = triangles[end / 3].v[end % 3];
    std::size_t same = 0, against = 0;
    around.for_edges(from, to, [&](std::uint32_t) { ++same; });
    around.for_edges(to, from, [&](std::uint32_t other) {
      ++against;
      fans.unite(corner, after(other));
      fans.unite(end, other);
    });
    if (same > 1 || against > 1) return std::nullopt;
    if (against == 0) border.push_back(corner);
    components.unite(corner, end);
  }
  std::size_t vertices = 0, pieces = 0, holes = 0;
  for (std::uint32_t corner = 0; corner < corners; ++corner) vertices += fans.find(corner) == corner;
  for (std::uint32_t corner = 0; corner < corners; ++corner) components.unite(corner, fans.find(corner));
  for (std::uint32_t corner = 0; corner < corners; ++corner) pieces += components.find(corner) == corner;
  for (const std::uint32_t corner : border) loops.unite(fans.find(corner), fans.find(after(corner)));
  for (const std::uint32_t corner : border) {
    const std::uint32_t fan = fans.find(corner);
    holes += loops.find(fan) == fan;
  }
  const std::size_t edges = (corners + border.size()) / 2;
  // 2 pieces - 2 handles - holes = vertices - edges + triangles.
  return (2 * pieces + edges - holes - vertices - triangles.size()) / 2;
}

namespace {

std::uint32_t vertex_at(const IndexedMesh& mesh, std::uint32_t triangle, std::uint32_t corner) {
  const std::uint32_t v = mesh.triangles[triangle].v[corner % 3];
  return mesh.wedges.vertex.empty() ? v : mesh.wedges.vertex[v];
}

}  // namespace

std::vector<LoneEdge> border_edges(const IndexedMesh& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  const auto key = [&](std::uint32_t t, std::uint32_t k) {
    const std::uint64_t a = vertex_at(mesh, t, k), b = vertex_at(mesh, t, k + 1);
    return std::min(a, b) << 32 | std::max(a, b);
  };
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < count; ++t)
    for (std::uint32_t k = 0; k < 3; ++k) edges.push_back(key(t, k));
  std::sort(edges.begin(), edges.end());
  // Most vertices are on none of them, which need not be looked for.
  std::vector<bool> on_border(mesh.positions.size(), false);
  std::size_t lone = 0;
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    while (last < edges.size() && edges[last] == edges[first]) ++last;
    if (last - first > 1) continue;
    on_border[edges[first] >> 32] = on_border[edges[first] & 0xFFFF'FFFFu] = true;
    edges[lone++] = std::uint64_t{edges[first]};
  }
  edges.resize(lone);
  std::vector<LoneEdge> border;
  for (std::uint32_t t = 0; t < count; ++t)
    for (std::uint32_t k = 0; k < 3; ++k)
      if (on_border[vertex_at(mesh, t, k)] && on_border[vertex_at(mesh, t, k + 1)] &&
          std::binary_search(edges.begin(), edges.end(), key(t, k)))
        border.push_back({t, k});
  return border;
}

namespace {

// Points of a border without those that tell nothing beside a kept one of their cube: no farther than half its side
// from it, and facing the same way. Where edges crowd, what is kept follows the space that they are in.
class SparseBorder {
 public:
  explicit SparseBorder(double spacing) : cube_(static_cast<float>(spacing)) {}

  void add(const BorderPoint& point) {
    std::uint32_t& last = last_.try_emplace(key(point.position), none).first->second;
    for (std::uint32_t k = last; k != none; k = before_[k])
      if (tells_same(points[k], point)) return;
    before_.push_back(last);
    last = static_cast<std::uint32_t>(points.size());
    points.push_back(point);
  }

  std::vector<BorderPoint> points;

 private:
  static constexpr std::uint32_t none = 0xFFFF'FFFFu;
  static constexpr float same_way = 0.9f;  // least cosine

  [[nodiscard]] bool tells_same(const BorderPoint& kept, const BorderPoint& point) const {
    const Vec3f d = kept.position - point.position;
    return 4 * dot(d, d) <= cube_ * cube_ && dot(kept.outward, point.outward) >= same_way;
  }
  [[nodiscard]] std::uint64_t key(Vec3f p) const {
    const auto part = [&](float x) { return static_cast<std::uint64_t>(std::floor(x / cube_)) & 0x1F'FFFF; };
    return part(p.x) | part(p.y) << 21 | part(p.z) << 42;
  }

  float cube_;
  std::unordered_map<std::uint64_t, std::uint32_t> last_;  // the point of each cube that came last
  std::vector<std::uint32_t> before_;                      // of each point, in its cube
};

}  // namespace

std::vector<BorderPoint> border_points(const IndexedMesh& mesh, std::span<const LoneEdge> border, double spacing) {
  SparseBorder points(spacing);
  for (const LoneEdge& edge : border) {
    const auto at = [&](std::uint32_t k) { return mesh.positions[vertex_at(mesh, edge.triangle, edge.corner + k)]; };
    const Vec3f a = at(0), along = at(1) - a, across = cross(along, cross(along, at(2) - a));
    const Vec3f outward = unit_normal(to_double(across));
    const int steps = static_cast<int>(std::ceil(length(along) / spacing));
    for (int k = 0; k <= steps; ++k)
      points.add({a + (static_cast<float>(k) / static_cast<float>(std::max(steps, 1))) * along, outward});
  }
  return std::move(points.points);
}

double narrowest_width(const IndexedMesh& mesh, std::span<const std::uint32_t> parts,
                       std::span<const LoneEdge> border) {
  const auto part = [&](std::size_t t) { return parts.empty() ? 0 : parts[t]; };
  const std::size_t count = parts.empty() ? 1 : 1 + *std::max_element(parts.begin(), parts.end());
  std::vector<double> area(count, 0), around(count, 0);
  double whole = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto at = [&](std::uint32_t k) { return to_double(mesh.positions[vertex_at(mesh, t, k)]); };
    const double own = 0.5 * length(cross(at(1) - at(0), at(2) - at(0)));
    area[part(t)] += own, whole += own;
  }
  for (const LoneEdge& edge : border)
    around[part(edge.triangle)] += length(to_double(mesh.positions[vertex_at(mesh, edge.triangle, edge.corner + 1)]) -
                                          to_double(mesh.positions[vertex_at(mesh, edge.triangle, edge.corner)]));
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = parts.empty() ? 0 : 1; k < count; ++k)
    if (around[k] > 0 && area[k] > 0.01 * whole) least = std::min(least, 2 * area[k] / around[k]);
  return least;
}

}  // namespace lodestone
