#include "render/reconstruct/edit_mesh.h"

#include <algorithm>

namespace lodestone {

std::uint32_t EditMesh::at(std::uint32_t a, std::uint32_t b) const {
  for (const std::uint32_t t : around_[a]) {
    const auto& v = triangles_[t].v;
    if ((v[0] == a && v[1] == b) || (v[1] == a && v[2] == b) || (v[2] == a && v[0] == b)) return t;
  }
  return none;
}

std::uint32_t EditMesh::opposite(std::uint32_t t, std::uint32_t a, std::uint32_t b) const {
  const auto& v = triangles_[t].v;
  return v[0] != a && v[0] != b ? v[0] : v[1] != a && v[1] != b ? v[1] : v[2];
}

std::uint32_t EditMesh::add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (a == b || b == c || c == a) return none;
  if (at(a, b) != none || at(b, c) != none || at(c, a) != none) return none;
  const auto t = static_cast<std::uint32_t>(triangles_.size());
  triangles_.push_back({{a, b, c}});
  for (const std::uint32_t v : {a, b, c}) around_[v].push_back(t);
  return t;
}

void EditMesh::remove(std::uint32_t triangle) {
  for (const std::uint32_t v : triangles_[triangle].v) std::erase(around_[v], triangle);
  triangles_[triangle].v = {none, none, none};
}

std::uint32_t EditMesh::next_on_border(std::uint32_t a, std::uint32_t b) const {
  // Turn about b from the triangle inside of a -> b: each step crosses an edge that leaves b.
  std::uint32_t from = a;
  for (std::size_t step = 0; step <= around_[b].size(); ++step) {
    const std::uint32_t t = at(from, b);
    if (t == none) return from;
    from = opposite(t, from, b);
  }
  return none;
}

std::vector<EditMesh::Gap> EditMesh::gaps(std::uint32_t v) const {
  std::vector<Gap> found;
  for (const std::uint32_t t : around_[v]) {
    const auto& c = triangles_[t].v;
    const std::uint32_t previous = c[0] == v ? c[2] : c[1] == v ? c[0] : c[1];  // previous -> v
    if (at(v, previous) == none) found.push_back({next_on_border(previous, v), previous});
  }
  return found;
}

}  // namespace lodestone
