#include "render/reconstruct/finish/label_parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/disjoint_sets.h"

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
  // Corners at `from` whose triangle goes on to `to`.
  template <class Visit>
  void for_edges(std::uint32_t from, std::uint32_t to, const Visit& visit) const {
    for (std::uint32_t k = first_[from]; k < first_[from + 1]; ++k)
      if (triangles_[corner_[k] / 3].v[(corner_[k] + 1) % 3] == to) visit(corner_[k]);
  }

 private:
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

std::vector<Vec3f> border_points(const IndexedMesh& mesh, double spacing) {
  const auto vertex = [&](std::uint32_t v) { return mesh.wedges.vertex.empty() ? v : mesh.wedges.vertex[v]; };
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t a = vertex(t.v[k]), b = vertex(t.v[(k + 1) % 3]);
      edges.push_back(std::min(a, b) << 32 | std::max(a, b));
    }
  std::sort(edges.begin(), edges.end());
  std::vector<Vec3f> points;
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    while (last < edges.size() && edges[last] == edges[first]) ++last;
    if (last - first > 1) continue;
    const Vec3f a = mesh.positions[edges[first] >> 32], b = mesh.positions[edges[first] & 0xFFFF'FFFFu];
    const int steps = static_cast<int>(std::ceil(length(b - a) / spacing));
    for (int k = 0; k <= steps; ++k)
      points.push_back(a + (static_cast<float>(k) / static_cast<float>(std::max(steps, 1))) * (b - a));
  }
  return points;
}

}  // namespace lodestone
