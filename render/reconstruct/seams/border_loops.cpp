#include "render/reconstruct/seams/border_loops.h"

#include "core/base/sort_unique.h"

namespace lodestone {

VertexId BorderLoops::add_vertex() {
  first_.push_back(none);
  return VertexId(first_.size() - 1);
}

BorderEdgeId BorderLoops::add_edge(VertexId from, VertexId to) {
  const BorderEdgeId e(edges_.size());
  edges_.push_back({.from = from, .to = to, .sibling = first_[from]});
  first_[from] = e;
  return e;
}

void BorderLoops::link(BorderEdgeId edge, BorderEdgeId next) {
  if (edge != none) edges_[edge].next = next;
  if (next != none) edges_[next].previous = edge;
}

std::vector<VertexId> BorderLoops::pinched() const {
  std::vector<VertexId> all = pinched_;
  for (const Edge& e : edges_)
    if (e.from != no_vertex && e.sibling != none) all.push_back(e.from);
  sort_unique(all);
  return all;
}

BorderEdgeId BorderLoops::find(VertexId from, VertexId to) const {
  BorderEdgeId e = first_[from];
  while (e != none && edges_[e].to != to) e = edges_[e].sibling;
  return e;
}

void BorderLoops::label(std::span<const std::uint32_t> piece_of_edge, std::size_t pieces) {
  pieces_ = DisjointSets(pieces);
  for (BorderEdgeId e{0}; e < edges_.size(); ++e) {
    if (!alive(e)) continue;
    if (edges_[e].loop != no_loop) continue;
    const auto loop = static_cast<std::uint32_t>(loops_.size());
    loops_.push_back({0, piece_of_edge[e]});
    for (BorderEdgeId f = e; edges_[f].loop == no_loop; f = edges_[f].next) edges_[f].loop = loop, ++loops_[loop].size;
  }
}

BorderLoops::Sides BorderLoops::add_triangle(BorderEdgeId edge, VertexId apex) {
  const VertexId from = edges_[edge].from, to = edges_[edge].to;
  const BorderEdgeId before = find(apex, from), after = find(to, apex);
  // An ear: the edge turns aside to the apex, a new one leads back.
  const BorderEdgeId next = edges_[edge].next, back = add_edge(apex, to);
  edges_[edge].to = apex;
  edges_[edge].tried = false;
  link(edge, back);
  link(back, next);
  if (!loops_.empty()) {
    edges_[back].loop = edges_[edge].loop;
    ++loops_[edges_[edge].loop].size;
  }
  Sides sides{edge, back};
  if (before != none) glue(edge, before), sides.left = none;
  if (after != none) glue(back, after), sides.right = none;
  return sides;
}

void BorderLoops::move_start(BorderEdgeId edge, VertexId vertex) {
  unlist(edge);
  edges_[edge].from = vertex;
  edges_[edge].sibling = first_[vertex];
  first_[vertex] = edge;
  edges_[edges_[edge].previous].to = vertex;
}

void BorderLoops::forget(VertexId vertex) {
  for (BorderEdgeId e = first_[vertex]; e != none; e = edges_[e].sibling) edges_[e].from = no_vertex;
  first_[vertex] = none;
}

bool BorderLoops::makes_handle(BorderEdgeId edge, VertexId apex) const {
  const Edge& e = edges_[edge];
  const BorderEdgeId before = find(apex, e.from), after = find(e.to, apex);
  const bool glues_before = before != none && e.previous != before, glues_after = after != none && e.next != after;
  if (glues_before && glues_after && edges_[after].next != before) return true;  // or may: rare, and left alone
  if (glues_before && joins_own_piece(edge, before)) return true;
  if (glues_after && joins_own_piece(edge, after)) return true;
  if (before != none || after != none) return false;
  for (BorderEdgeId f = first_[apex]; f != none; f = edges_[f].sibling)
    if (!joins_own_piece(edge, f)) return false;
  return true;
}

void BorderLoops::glue(BorderEdgeId x, BorderEdgeId y) {
  const VertexId from = edges_[x].from, to = edges_[x].to;
  const bool labelled = !loops_.empty(), same = edges_[x].loop == edges_[y].loop;
  if (labelled && !same) join_loops(x, y);
  const BorderEdgeId before_x = edges_[x].previous, after_x = edges_[x].next;
  const BorderEdgeId before_y = edges_[y].previous, after_y = edges_[y].next;
  if (after_x != y) link(before_y, after_x);
  if (before_x != y) link(before_x, after_y);
  if (labelled) loops_[edges_[x].loop].size -= 2;
  for (const BorderEdgeId e : {x, y}) {
    unlist(e);
    edges_[e].from = no_vertex;
  }
  if (after_x == y && first_[to] != none) pinched_.push_back(to);
  if (before_x == y && first_[from] != none) pinched_.push_back(from);
  if (labelled && same && after_x != y && before_x != y) split_loop(after_y, after_x);
}

void BorderLoops::join_loops(BorderEdgeId x, BorderEdgeId y) {
  std::uint32_t larger = edges_[x].loop, smaller = edges_[y].loop;
  BorderEdgeId start = y;
  if (loops_[smaller].size > loops_[larger].size) std::swap(larger, smaller), start = x;
  if (!pieces_.unite(loops_[larger].piece, loops_[smaller].piece)) ++handles_;
  loops_[larger].size += loops_[smaller].size;
  relabel(start, larger);
}

// s and t are of one loop no longer. Walking both ways at once takes as long as the shorter one.
void BorderLoops::split_loop(BorderEdgeId s, BorderEdgeId t) {
  BorderEdgeId at_s = s, at_t = t;
  std::uint32_t count = 0;
  do {
    at_s = edges_[at_s].next, at_t = edges_[at_t].next;
    ++count;
  } while (at_s != s && at_t != t);
  const std::uint32_t old = edges_[s].loop;
  const auto loop = static_cast<std::uint32_t>(loops_.size());
  loops_.push_back({count, loops_[old].piece});
  loops_[old].size -= count;
  relabel(at_s == s ? s : t, loop);
}

void BorderLoops::relabel(BorderEdgeId start, std::uint32_t loop) {
  for (BorderEdgeId f = start; edges_[f].loop != loop; f = edges_[f].next) edges_[f].loop = loop;
}

void BorderLoops::unlist(BorderEdgeId e) {
  BorderEdgeId* at = &first_[edges_[e].from];
  while (*at != e) at = &edges_[*at].sibling;
  *at = edges_[e].sibling;
}

}  // namespace lodestone
