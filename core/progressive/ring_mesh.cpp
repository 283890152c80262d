// Rings from triangles: fans are chained corner by corner; where they cannot be, the surface is cut (gueziec2001, with
// the triangles at an edge paired by their angle around it, so that what is closed stays closed).
#include "core/progressive/ring_mesh.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace lodestone::progressive {
namespace {

constexpr std::uint32_t spare = 2;  // neighbours that a ring has room for beyond those it starts with

// Corners that start or end at one neighbour, of triangles that share the edge to it.
struct EdgeCorner {
  std::uint32_t corner = 0;
  bool forward = false;  // the triangle runs from the lower end to the higher one
  double angle = 0;      // around the edge, from the lower end to the higher one
  Vec3f third;           // its corner opposite the edge
};

// Any two vectors that make a right-handed frame with the axis; the same for the same axis.
std::pair<Vec3d, Vec3d> frame_around(Vec3d axis) {
  const Vec3d other = std::abs(axis.x) <= std::abs(axis.y) && std::abs(axis.x) <= std::abs(axis.z) ? Vec3d{1, 0, 0}
                      : std::abs(axis.y) <= std::abs(axis.z)                                       ? Vec3d{0, 1, 0}
                                                                                                   : Vec3d{0, 0, 1};
  const Vec3d first = cross(axis, other);
  return {first, cross(axis, first)};
}

// By coordinates: what is decided with it does not depend on how vertices are numbered.
bool is_lower(Vec3f a, Vec3f b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

bool comes_before(const EdgeCorner& a, const EdgeCorner& b) {
  if (a.angle != b.angle) return a.angle < b.angle;
  if (!(a.third == b.third)) return is_lower(a.third, b.third);
  return a.forward < b.forward;
}

// Pairs triangles of an edge that bound the same solid: it begins behind a backward triangle and ends at a forward one.
// Two turns around the edge, as brackets may begin anywhere.
std::vector<std::pair<std::uint32_t, std::uint32_t>> pair_brackets(std::span<const EdgeCorner> sorted) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::vector<std::size_t> pending;
  std::vector<bool> done(sorted.size());
  for (std::size_t step = 0; step < 2 * sorted.size(); ++step) {
    const std::size_t k = step % sorted.size();
    if (done[k]) continue;
    if (!sorted[k].forward) {
      if (step < sorted.size()) pending.push_back(k);
    } else if (!pending.empty()) {
      pairs.emplace_back(sorted[pending.back()].corner, sorted[k].corner);
      done[pending.back()] = done[k] = true;
      pending.pop_back();
    }
  }
  return pairs;
}

}  // namespace

Id* RingArena::take(std::size_t count) {
  constexpr std::size_t chunk = 4096;
  if (count > left_) {
    left_ = std::max(chunk, count);
    chunks_.push_back(std::make_unique_for_overwrite<Id[]>(left_));
    next_ = chunks_.back().get();
  }
  left_ -= count;
  return std::exchange(next_, next_ + count);
}

RingMesh::RingMesh(const IndexedMesh& mesh)
    : input_(&mesh), corners_(mesh.triangles), rings_(mesh.positions.size()), positions_(mesh.positions.data()) {
  const std::vector<Id>& vertex = mesh.wedges.vertex;
  for (std::size_t w = 0; w < vertex.size() && !has_wedges_; ++w) has_wedges_ = vertex[w] != w;
}

Id RingMesh::vertex_of(Id wedge) const {
  if (wedge >= input_vertices()) return copy_vertex_[wedge - input_vertices()];
  return has_wedges_ ? input_->wedges.vertex[wedge] : wedge;
}

Id RingMesh::position_id(std::uint32_t corner) const {
  const Id wedge = input_->triangles[corner / 3].v[corner % 3];
  return has_wedges_ ? input_->wedges.vertex[wedge] : wedge;
}

void RingMesh::list_corners() {
  const auto count = static_cast<std::uint32_t>(3 * corners_.size());
  first_.assign(input_vertices() + 1, 0);
  for (std::uint32_t c = 0; c < count; ++c) ++first_[position_id(c) + 1];
  for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
  by_vertex_.resize(count);
  std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
  for (std::uint32_t c = 0; c < count; ++c) by_vertex_[fill[position_id(c)]++] = c;
  shape_.assign(input_vertices(), Shape::closed);
}

void RingMesh::find_fans(std::size_t begin, std::size_t end) {
  for (std::size_t v = begin; v < end; ++v)
    shape_[v] = chain_simply(std::span(by_vertex_).subspan(first_[v], first_[v + 1] - first_[v]));
}

// Brings the corners of a single fan into its order; leaves them alone where that needs a closer look.
RingMesh::Shape RingMesh::chain_simply(std::span<std::uint32_t> corners) const {
  constexpr std::size_t most = 32;
  const std::size_t n = corners.size();
  if (n == 0) return Shape::closed;
  if (n > most) return Shape::several;
  Id start[most], end[most];
  std::uint32_t next[most];
  for (std::size_t k = 0; k < n; ++k) start[k] = start_of(corners[k]), end[k] = end_of(corners[k]);
  std::uint32_t has_before = 0;
  for (std::size_t k = 0; k < n; ++k) {
    next[k] = no_id;
    for (std::size_t m = 0; m < n; ++m) {
      if (m != k && (start[m] == start[k] || end[m] == end[k])) return Shape::several;
      if (start[m] != end[k]) continue;
      next[k] = static_cast<std::uint32_t>(m);
      has_before |= 1u << m;
    }
  }
  const std::uint32_t all = n == 32 ? 0xffff'ffffu : (1u << n) - 1;
  std::uint32_t k = 0;  // the first corner of an open fan; of a closed one, the first of the input
  while (has_before != all && (has_before >> k & 1u) != 0) ++k;
  std::uint32_t ordered[most];
  std::size_t length = 0;
  for (; k != no_id && length < n && (length == 0 || corners[k] != ordered[0]); k = next[k])
    ordered[length++] = corners[k];
  if (length < n) return Shape::several;
  std::copy_n(ordered, n, corners.begin());
  return has_before == all ? Shape::closed : Shape::open;
}

// Any number of fans: corners follow each other over edges of two triangles, and over the pairs of edges of more.
void RingMesh::chain_any(Id vertex, std::vector<Cut>& cuts) {
  const std::span corners = std::span(by_vertex_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  std::vector<std::pair<Id, std::uint32_t>> edges;  // neighbour; corner, twice, plus one where it ends there
  for (std::uint32_t k = 0; k < corners.size(); ++k) {
    edges.emplace_back(start_of(corners[k]), 2 * k);
    edges.emplace_back(end_of(corners[k]), 2 * k + 1);
  }
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint32_t> next(corners.size(), no_id), before(corners.size(), no_id);
  for (auto from = edges.begin(); from != edges.end();) {
    const Id other = from->first;
    const auto to = std::find_if(from, edges.end(), [&](const auto& e) { return e.first != other; });
    const bool plain = to - from == 1 || (to - from == 2 && (from->second + (from + 1)->second) % 2 == 1);
    const bool lower = is_lower(positions_[vertex], positions_[other]);
    if (!plain && lower) ++cut_edges_;
    const Vec3d origin = to_double(positions_[lower ? vertex : other]);
    const Vec3d axis = to_double(positions_[lower ? other : vertex]) - origin;
    const auto [x, y] = frame_around(axis);
    std::vector<EdgeCorner> around;
    for (auto e = from; e != to; ++e) {
      const std::uint32_t corner = corners[e->second / 2];
      const bool ends = e->second % 2 == 1;
      const Vec3f third = positions_[ends ? start_of(corner) : end_of(corner)];
      const Vec3d out = to_double(third) - origin;
      const double angle = std::atan2(dot(out, y) / std::max(length(axis), 1e-30), dot(out, x));
      around.push_back({e->second / 2, lower != ends, angle, third});
    }
    std::sort(around.begin(), around.end(), comes_before);
    for (const auto& [back, forth] : pair_brackets(around)) {
      const auto [ending, starting] = lower ? std::pair(back, forth) : std::pair(forth, back);
      next[ending] = starting, before[starting] = ending;
    }
    from = to;
  }
  std::vector<std::uint32_t> ordered;
  std::vector<bool> done(corners.size());
  const auto walk = [&](std::uint32_t k, bool open) {
    const auto begin = static_cast<std::uint32_t>(first_[vertex] + ordered.size());
    for (; k != no_id && !done[k]; k = next[k]) ordered.push_back(corners[k]), done[k] = true;
    cuts.push_back({vertex, begin, static_cast<std::uint32_t>(first_[vertex] + ordered.size()), open});
  };
  for (std::uint32_t k = 0; k < corners.size(); ++k)
    if (before[k] == no_id) walk(k, true);
  for (std::uint32_t k = 0; k < corners.size(); ++k)
    if (!done[k]) walk(k, false);
  std::copy(ordered.begin(), ordered.end(), corners.begin());
}

// Every fan of a vertex but the first gets a copy of it.
void RingMesh::cut_open() {
  for (Id v = 0; v < shape_.size(); ++v)
    if (shape_[v] == Shape::several) chain_any(v, cuts_);
  for (std::size_t k = 1; k < cuts_.size(); ++k)
    if (cuts_[k].vertex == cuts_[k - 1].vertex) copy_fan(cuts_[k]);
  rings_.resize(input_vertices() + copy_source_.size());
  store_.resize((by_vertex_.size() + spare * input_vertices()) * (has_wedges_ ? 2 : 1));
  if (copy_source_.empty()) return;
  own_positions_ = input_->positions;
  for (const Id source : copy_source_) own_positions_.push_back(input_->positions[source]);
  positions_ = own_positions_.data();
}

void RingMesh::copy_fan(const Cut& cut) {
  ++cut_vertices_;
  const auto first_copy = static_cast<Id>(input_vertices() + copy_source_.size());
  for (std::uint32_t k = cut.begin; k < cut.end; ++k) {
    Id& id = corner_id(by_vertex_[k]);
    const auto begin = copy_source_.begin() + (first_copy - static_cast<Id>(input_vertices()));
    const auto known = std::find(begin, copy_source_.end(), id);
    const auto copy = static_cast<Id>(input_vertices() + static_cast<std::size_t>(known - copy_source_.begin()));
    if (known == copy_source_.end()) {
      copy_source_.push_back(id);
      copy_vertex_.push_back(first_copy);
    }
    id = copy;
  }
}

void RingMesh::make_rings(std::size_t begin, std::size_t end) {
  for (std::size_t v = begin; v < end; ++v) {
    const std::span corners = std::span(by_vertex_).subspan(first_[v], first_[v + 1] - first_[v]);
    if (shape_[v] == Shape::several || corners.empty()) continue;
    Id* place = store_.data() + (first_[v] + spare * v) * (has_wedges_ ? 2 : 1);
    make_ring(static_cast<Id>(v), corners, shape_[v] == Shape::open, place);
  }
}

void RingMesh::finish_rings() {
  for (const Cut& cut : cuts_) {
    const std::span corners = std::span(by_vertex_).subspan(cut.begin, cut.end - cut.begin);
    Id* place = arena_.take((corners.size() + spare) * (has_wedges_ ? 2 : 1));
    make_ring(vertex_of(corner_id(corners.front())), corners, cut.open, place);
  }
  first_ = {}, by_vertex_ = {}, shape_ = {}, cuts_ = {};
}

void RingMesh::make_ring(Id v, std::span<const std::uint32_t> corners, bool open, Id* place) {
  const auto count = static_cast<std::uint32_t>(corners.size());
  Ring& ring = rings_[v];
  ring = {place, count + (open ? 1u : 0u), (count + spare) & 0x7fff'ffffu, open ? 1u : 0u};
  const auto id = [&](std::uint32_t c, std::uint32_t step) { return corner_id(c - c % 3 + (c + step) % 3); };
  for (std::uint32_t k = 0; k < count; ++k) {
    ring.ids[k] = vertex_of(id(corners[k], 1));
    if (has_wedges_) ring.wedge(k) = id(corners[k], 0);
  }
  if (!open) return;
  ring.ids[count] = vertex_of(id(corners.back(), 2));
  if (has_wedges_) ring.wedge(count) = id(corners.back(), 0);
}

}  // namespace lodestone::progressive
