// Rings from triangles: fans are chained corner by corner.
#include "core/progressive/ring_mesh.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace lodestone::progressive {

Id* RingArena::take(std::size_t count) {
  constexpr std::size_t chunk = 4096;
  if (count + Ring::readable > left_) {
    left_ = std::max(chunk, count + Ring::readable);
    chunks_.push_back(std::make_unique_for_overwrite<Id[]>(left_));
    next_ = chunks_.back().get();
  }
  left_ -= count;
  return std::exchange(next_, next_ + count);
}

RingMesh::RingMesh(const IndexedMesh& mesh)
    : input_(&mesh), corners_(mesh.triangles), rings_(mesh.positions.size() + 1), points_(mesh.positions.size()) {
  const std::vector<Id>& vertex = mesh.wedges.vertex;
  for (std::size_t w = 0; w < vertex.size() && !has_wedges_; ++w) has_wedges_ = vertex[w] != w;
}

void RingMesh::list_corners() {
  first_.assign(input_vertices() + 1, 0);
  const auto for_corners = [&](auto&& visit) {
    for (std::uint32_t t = 0; t < corners_.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k) visit(4 * t + k, position_id(4 * t + k));
  };
  for_corners([&](std::uint32_t, Id v) { ++first_[v + 1]; });
  for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
  by_vertex_.resize(3 * corners_.size());
  std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
  for_corners([&](std::uint32_t corner, Id v) { by_vertex_[fill[v]++] = corner; });
  several_.assign(input_vertices(), 0);
}

void RingMesh::make_rings(std::size_t begin, std::size_t end, RingArena& arena, ChainFan chain) {
  for (std::size_t v = begin; v < end; ++v) {
    const Vec3f p = input_->positions[v];
    points_[v] = {p.x, p.y, p.z, 0};
    const std::span corners = std::span(by_vertex_).subspan(first_[v], first_[v + 1] - first_[v]);
    if (corners.empty()) continue;
    several_[v] = make_simple_ring(static_cast<Id>(v), corners, arena, chain) ? 0 : 1;
  }
}

// Of a single fan; leaves the others, which need a closer look.
bool RingMesh::make_simple_ring(Id v, std::span<const std::uint32_t> corners, RingArena& arena, ChainFan chain) {
  const auto n = static_cast<std::uint32_t>(corners.size());
  if (n > most_chained) return false;
  Id start[most_chained], end[most_chained];
  std::uint8_t order[most_chained];
  for (std::uint32_t k = 0; k < n; ++k) start[k] = start_of(corners[k]), end[k] = end_of(corners[k]);
  const Shape shape = (n <= 8 ? chain : chain_fan)(start, end, n, order);
  if (shape == Shape::several) return false;
  const bool open = shape == Shape::open;
  Ring& ring = begin_ring(v, n, open, arena);
  for (std::uint32_t k = 0; k < n; ++k) ring.ids[k] = start[order[k]];
  if (open) ring.ids[n] = end[order[n - 1]];
  if (!has_wedges_) return true;
  for (std::uint32_t k = 0; k < n; ++k) ring.wedge(k) = corner_id(corners[order[k]]);
  if (open) ring.wedge(n) = ring.wedge(n - 1);
  return true;
}

Shape chain_fan(const Id* start, const Id* end, std::uint32_t n, std::uint8_t* order) {
  std::uint8_t next[most_chained];
  std::uint32_t has_before = 0;
  for (std::uint32_t k = 0; k < n; ++k) {
    std::uint32_t behind = 0;
    for (std::uint32_t m = 0; m < n; ++m) behind |= static_cast<std::uint32_t>(start[m] == end[k]) << m;
    if ((behind & (behind - 1)) != 0 || (behind & has_before) != 0) return Shape::several;
    next[k] = static_cast<std::uint8_t>(std::countr_zero(behind));
    has_before |= behind;
  }
  return follow_fan(next, has_before, n, order);
}

// With its corners as they are now, on copies where the surface was cut.
void RingMesh::make_ring(Id v, std::span<const std::uint32_t> corners, bool open, RingArena& arena) {
  const auto count = static_cast<std::uint32_t>(corners.size());
  Ring& ring = begin_ring(v, count, open, arena);
  for (std::uint32_t k = 0; k < count; ++k) ring.ids[k] = vertex_of(corner_id(after(corners[k])));
  if (open) ring.ids[count] = vertex_of(corner_id(before(corners.back())));
  if (!has_wedges_) return;
  for (std::uint32_t k = 0; k < count; ++k) ring.wedge(k) = corner_id(corners[k]);
  if (open) ring.wedge(count) = corner_id(corners.back());
}

Ring& RingMesh::begin_ring(Id v, std::uint32_t corners, bool open, RingArena& arena) {
  Ring& ring = rings_[v];
  ring.size = corners + (open ? 1u : 0u);
  ring.open = open ? 1 : 0;
  ring.capacity = Ring::own_ids;
  ring.ids = ring.own;
  if (!has_wedges_ && ring.size <= Ring::own_ids) return ring;
  constexpr std::uint32_t spare = 2;  // to begin with
  ring.capacity = (ring.size + spare) & 0x7fff'ffffu;
  ring.ids = arena.take(std::size_t{ring.capacity} * (has_wedges_ ? 2 : 1));
  return ring;
}

}  // namespace lodestone::progressive
