#include "render/reconstruct/seams/edit_mesh.h"

#include <algorithm>
#include <iterator>
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
  for (TriangleId t{0}; t < triangles_.size(); ++t)
    for (const std::uint32_t v : triangles_[t].v) push(around_[v], t);
}

void EditMesh::push(List& list, TriangleId triangle) {
  if (list.count == list.room) {
    const auto begin = static_cast<std::uint32_t>(pool_.size());
    list.room = 2 * list.room + 4;
    pool_.resize(begin + list.room);
    std::copy_n(pool_.begin() + list.begin, list.count, pool_.begin() + begin);
    list.begin = begin;
  }
  pool_[list.begin + list.count++] = triangle;
}

TriangleId EditMesh::at(VertexId a, VertexId b) const {
  // One of the two may be the hub of a fan of any size; its neighbours are not.
  for (const TriangleId t : around(around_[a].count <= around_[b].count ? a : b)) {
    const auto& v = triangles_[t].v;
    if ((v[0] == a && v[1] == b) || (v[1] == a && v[2] == b) || (v[2] == a && v[0] == b)) return t;
  }
  return none;
}

VertexId EditMesh::opposite(TriangleId t, VertexId a, VertexId b) const {
  const auto v = corners(t);
  return v[0] != a && v[0] != b ? v[0] : v[1] != a && v[1] != b ? v[1] : v[2];
}

TriangleId EditMesh::add(VertexId a, VertexId b, VertexId c) {
  if (a == b || b == c || c == a) return none;
  if (at(a, b) != none || at(b, c) != none || at(c, a) != none) return none;
  const TriangleId t(triangles_.size());
  triangles_.push_back({{a, b, c}});
  for (const VertexId v : {a, b, c}) push(around_[v], t);
  return t;
}

void EditMesh::remove(TriangleId triangle) {
  for (const std::uint32_t v : triangles_[triangle].v) drop(around_[v], triangle);
  triangles_[triangle].v = {no_vertex, no_vertex, no_vertex};
}

void EditMesh::move_corner(TriangleId triangle, VertexId from, VertexId to) {
  drop(around_[from], triangle);
  push(around_[to], triangle);
  for (std::uint32_t& v : triangles_[triangle].v)
    if (v == from) v = to;
}

// From the end: what removes all triangles around a vertex does so in that order.
void EditMesh::drop(List& list, TriangleId triangle) {
  const auto begin = pool_.begin() + list.begin, end = begin + list.count;
  const auto after = std::find(std::make_reverse_iterator(end), std::make_reverse_iterator(begin), triangle).base();
  if (after == begin) return;
  std::copy(after, end, after - 1);
  --list.count;
}

VertexId EditMesh::next_on_border(VertexId a, VertexId b) const {
  // Turn about b from the triangle inside of a -> b: each step crosses an edge that leaves b.
  VertexId from = a;
  for (std::size_t step = 0; step <= around_[b].count; ++step) {
    const TriangleId t = at(from, b);
    if (t == none) return from;
    from = opposite(t, from, b);
  }
  return no_vertex;
}

std::vector<EditMesh::Gap> EditMesh::gaps(VertexId v) const {
  std::vector<Gap> found;
  for (const TriangleId t : around(v)) {
    const auto c = corners(t);
    const VertexId previous = c[0] == v ? c[2] : c[1] == v ? c[0] : c[1];  // previous -> v
    if (at(v, previous) == none) found.push_back({next_on_border(previous, v), previous});
  }
  return found;
}

std::vector<TriangleId> EditMesh::fan(VertexId v, TriangleId first) const {
  std::vector<TriangleId> fan{first};
  const auto after = [&](TriangleId t) {  // the corner that v goes on to
    const auto c = corners(t);
    return c[0] == v ? c[1] : c[1] == v ? c[2] : c[0];
  };
  for (TriangleId t = at(after(first), v); t != none; t = at(after(t), v)) {
    if (t == first) return fan;
    fan.push_back(t);
  }
  const auto before = [&](TriangleId t) { return opposite(t, v, after(t)); };
  for (TriangleId t = at(v, before(first)); t != none; t = at(v, before(t))) fan.push_back(t);
  return fan;
}

}  // namespace lodestone
