// Where the surface is nonmanifold it is cut (gueziec2001), with the triangles at an edge paired by their angle around
// it, so that closed surfaces remain closed.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/progressive/collapse/ring_mesh.h"

namespace lodestone::progressive {
namespace {

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

// By coordinates, so that decisions do not depend on how vertices are numbered.
bool is_lower(Vec3f a, Vec3f b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

bool comes_before(const EdgeCorner& a, const EdgeCorner& b) {
  if (a.angle != b.angle) return a.angle < b.angle;
  if (!(a.third == b.third)) return is_lower(a.third, b.third);
  return a.forward < b.forward;
}

// Pairs triangles of an edge that bound the same solid: it begins after a backward triangle and ends at a forward one.
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

// Chains any number of fans: corners follow each other over edges of two triangles, and over the pairs of larger edges.
void RingMesh::chain_any(Id vertex, std::vector<Cut>& cuts) {
  const std::span corners = corners_of(vertex);
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
    if (plain) {
      if (to - from == 2) {
        const std::uint32_t ending = (from->second % 2 == 1 ? from : from + 1)->second / 2;
        const std::uint32_t starting = (from->second % 2 == 1 ? from + 1 : from)->second / 2;
        next[ending] = starting, before[starting] = ending;
      }
      from = to;
      continue;
    }
    const bool lower = is_lower(position(vertex), position(other));
    if (lower) ++cut_edges_;
    const Vec3d origin = to_double(position(lower ? vertex : other));
    const Vec3d axis = to_double(position(lower ? other : vertex)) - origin;
    const auto [x, y] = frame_around(axis);
    std::vector<EdgeCorner> around;
    for (auto e = from; e != to; ++e) {
      const std::uint32_t corner = corners[e->second / 2];
      const bool ends = e->second % 2 == 1;
      const Vec3f third = position(ends ? start_of(corner) : end_of(corner));
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
  std::vector<Cut> cuts;
  for (Id v = 0; v < several_.size(); ++v)
    if (several_[v] != 0) chain_any(v, cuts);
  for (std::size_t k = 1; k < cuts.size(); ++k)
    if (cuts[k].vertex == cuts[k - 1].vertex) copy_fan(cuts[k]);
  if (vertex_count() > room_) make_room();
  for (Id v = static_cast<Id>(input_vertices()); v < vertex_count(); ++v) {
    points_[v] = points_[vertex_of(source_of(v))];
    rings_[v].clear();
  }
  for (const Cut& cut : cuts) {
    const std::span corners(by_vertex_.get() + cut.begin, cut.end - cut.begin);
    make_ring(vertex_of(corner_id(corners.front())), corners, cut.open, arena_);
  }
  for (const Cut& cut : cuts) name_copy(cut);
  first_ = {}, by_vertex_.reset(), several_ = {};
}

void RingMesh::make_room() {
  room_ = vertex_count();
  auto rings = std::make_unique_for_overwrite<Ring[]>(room_ + 1);
  auto points = std::make_unique_for_overwrite<AlignedPoint[]>(room_ + 1);
  std::copy_n(rings_.get(), input_vertices(), rings.get());
  std::copy_n(points_.get(), input_vertices(), points.get());
  rings_ = std::move(rings);
  points_ = std::move(points);
}

// Neighbours of a copy that have one fan know the vertex by its old number.
void RingMesh::name_copy(const Cut& cut) {
  const Id copy = vertex_of(corner_id(by_vertex_[cut.begin]));
  if (copy == cut.vertex) return;
  for (const Id x : rings_[copy].neighbours())
    if (Ring& ring = rings_[x]; x < several_.size() && several_[x] == 0) ring.ids[ring.find(cut.vertex)] = copy;
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

}  // namespace lodestone::progressive
