#include "render/reconstruct/label_parts.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/disjoint_sets.h"

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
