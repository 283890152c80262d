#include "render/reconstruct/label_parts.h"

#include <algorithm>
#include <numeric>

namespace lodestone {

std::vector<std::uint32_t> label_parts(const IndexedMesh& mesh, double least_share) {
  std::vector<std::uint32_t> root(mesh.positions.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  const auto unite = [&](std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    root[std::max(a, b)] = std::min(a, b);
  };
  for (std::uint32_t w = 0; w < mesh.wedges.vertex.size(); ++w) unite(w, mesh.wedges.vertex[w]);
  for (const Triangle& t : mesh.triangles) unite(t.v[0], t.v[1]), unite(t.v[1], t.v[2]);

  std::vector<std::uint32_t> size(root.size(), 0), number(root.size(), 0);
  for (const Triangle& t : mesh.triangles) ++size[find(t.v[0])];
  const double least = least_share * static_cast<double>(mesh.triangles.size());
  std::uint32_t next = 0;
  bool rest = false;
  for (std::uint32_t v = 0; v < root.size(); ++v) {
    if (size[v] == 0) continue;
    if (static_cast<double>(size[v]) < least)
      rest = true;
    else
      number[v] = ++next;
  }
  if (next + (rest ? 1 : 0) < 2) return {};
  std::vector<std::uint32_t> parts;
  parts.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) parts.push_back(number[find(t.v[0])]);
  return parts;
}

}  // namespace lodestone
