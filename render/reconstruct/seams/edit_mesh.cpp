#include "render/reconstruct/seams/edit_mesh.h"

#include <algorithm>
#include <utility>

namespace lodestone {

EditMesh::EditMesh(std::size_t vertices, std::vector<Triangle> triangles)
    : triangles_(std::move(triangles)), around_(vertices) {
  for (const Triangle& t : triangles_)
    for (const std::uint32_t v : t.v) ++around_[v].room;
  std::uint32_t end = 0;
  for (List& list : around_) {
    list.begin = end;
    list.room += 2;  // for what comes to a border
    end += list.room;
  }
  pool_.resize(end);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t)
    for (const std::uint32_t v : triangles_[t].v) push(around_[v], t);
}

void EditMesh::push(List& list, std::uint32_t triangle) {
  if (list.count == list.room) {
    const auto begin = static_cast<std::uint32_t>(pool_.size());
    list.room = 2 * list.room + 4;
    pool_.resize(begin + list.room);
    std::copy_n(pool_.begin() + list.begin, list.count, pool_.begin() + begin);
    list.begin = begin;
  }
  pool_[list.begin + list.count++] = triangle;
}

std::uint32_t EditMesh::at(std::uint32_t a, std::uint32_t b) const {
  for (const std::uint32_t t : around(a)) {
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
  for (const std::uint32_t v : {a, b, c}) push(around_[v], t);
  return t;
}

void EditMesh::remove(std::uint32_t triangle) {
  for (const std::uint32_t v : triangles_[triangle].v) drop(around_[v], triangle);
  triangles_[triangle].v = {none, none, none};
}

void EditMesh::move_corner(std::uint32_t triangle, std::uint32_t from, std::uint32_t to) {
  drop(around_[from], triangle);
  push(around_[to], triangle);
  std::replace(triangles_[triangle].v.begin(), triangles_[triangle].v.end(), from, to);
}

void EditMesh::drop(List& list, std::uint32_t triangle) {
  const auto begin = pool_.begin() + list.begin, end = begin + list.count;
  list.count = static_cast<std::uint32_t>(std::remove(begin, end, triangle) - begin);
}

std::uint32_t EditMesh::next_on_border(std::uint32_t a, std::uint32_t b) const {
  // Turn about b from the triangle inside of a -> b: each step crosses an edge that leaves b.
  std::uint32_t from = a;
  for (std::size_t step = 0; step <= around_[b].count; ++step) {
    const std::uint32_t t = at(from, b);
    if (t == none) return from;
    from = opposite(t, from, b);
  }
  return none;
}

std::vector<EditMesh::Gap> EditMesh::gaps(std::uint32_t v) const {
  std::vector<Gap> found;
  for (const std::uint32_t t : around(v)) {
    const auto& c = triangles_[t].v;
    const std::uint32_t previous = c[0] == v ? c[2] : c[1] == v ? c[0] : c[1];  // previous -> v
    if (at(v, previous) == none) found.push_back({next_on_border(previous, v), previous});
  }
  return found;
}

std::vector<std::uint32_t> EditMesh::fan(std::uint32_t v, std::uint32_t first) const {
  std::vector<std::uint32_t> fan{first};
  for (std::size_t k = 0; k < fan.size(); ++k)
    for (const std::uint32_t t : around(v)) {
      if (std::find(fan.begin(), fan.end(), t) != fan.end()) continue;
      const auto& c = triangle(fan[k]).v;
      for (const std::uint32_t w : c)
        if (w != v && (at(v, w) == t || at(w, v) == t)) {
          fan.push_back(t);
          break;
        }
    }
  return fan;
}

}  // namespace lodestone
