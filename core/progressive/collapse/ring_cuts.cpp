// Where the surface is nonmanifold it is cut (gueziec2001), with the triangles at an edge paired by their angle around
// it, so that closed surfaces remain closed.
#include <algorithm>
#include <utility>

#include "core/mesh/edge_pairing.h"
#include "core/progressive/collapse/ring_mesh.h"

namespace lodestone::progressive {

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
    std::vector<EdgeTriangle> around;
    for (auto e = from; e != to; ++e) {
      const std::uint32_t corner = corners[e->second / 2];
      const bool ends = e->second % 2 == 1;
      around.push_back({e->second / 2, lower != ends, position(ends ? start_of(corner) : end_of(corner))});
    }
    const Vec3f low = position(lower ? vertex : other), high = position(lower ? other : vertex);
    for (const auto& [back, forth] : pair_around_edge(low, high, around)) {
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
    points_[v] = points_[original_of(v)];
    rings_[v].clear();
  }
  for (const Cut& cut : cuts) {
    const std::span corners(by_vertex_.get() + cut.begin, cut.end - cut.begin);
    make_ring(vertex_of(corner_id(corners.front())), corners, cut.open, arena_);
  }
  for (const Cut& cut : cuts) name_copy(cut);
  first_ = std::vector<std::uint32_t>(), by_vertex_.reset();  // an empty list {} would keep the memory
  several_ = std::vector<std::uint8_t>();
}

// Copies are numbered in the order of the vertices that they are made of.
std::pair<Id, Id> RingMesh::copies_of(Id original) const {
  const auto before = [&](Id source, Id vertex) { return vertex_of(source) < vertex; };
  const auto first = std::lower_bound(copy_source_.begin(), copy_source_.end(), original, before);
  const auto last = std::lower_bound(first, copy_source_.end(), original + 1, before);
  const auto number = [&](auto at) {
    return static_cast<Id>(input_vertices() + static_cast<std::size_t>(at - copy_source_.begin()));
  };
  return {number(first), number(last)};
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
  if (corners_.empty()) corners_ = input_->triangles;
  ++cut_vertices_;
  const auto first_copy = static_cast<Id>(input_vertices() + copy_source_.size());
  for (std::uint32_t k = cut.begin; k < cut.end; ++k) {
    Id& id = corners_[by_vertex_[k] / 4].v[by_vertex_[k] % 4];
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
