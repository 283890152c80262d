// Rings from triangles: fans are chained corner by corner.
#include "core/progressive/collapse/ring_mesh.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <utility>

#include "core/base/prefetch.h"

namespace lodestone::progressive {

constexpr std::size_t vertices_ahead = 8;  // whose triangles are asked for

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
    : input_(&mesh), room_(mesh.positions.size() + mesh.positions.size() / 16 + 1) {
  const std::vector<Id>& vertex = mesh.wedges.vertex;
  for (std::size_t w = 0; w < vertex.size() && !has_wedges_; ++w) has_wedges_ = vertex[w] != w;
  rings_ = std::make_unique_for_overwrite<Ring[]>(room_ + 1);
  points_ = std::make_unique_for_overwrite<AlignedPoint[]>(room_ + 1);
}

void RingMesh::list_corners() {
  first_.assign(input_vertices() + 2, 0);
  several_.resize(input_vertices());
  by_vertex_ = std::make_unique_for_overwrite<std::uint32_t[]>(3 * input_->triangles.size() + 8);
  std::fill_n(by_vertex_.get() + 3 * input_->triangles.size(), 8, 0u);  // read by make_simple_ring
  const auto list = [&](auto&& vertex_of_corner) {
    // Counted two places further on, so that filling leaves every range in its place.
    for (const Triangle& t : input_->triangles)
      for (const Id id : t.v) ++first_[vertex_of_corner(id) + 2];
    for (std::size_t v = 2; v < first_.size(); ++v) first_[v] += first_[v - 1];
    std::uint32_t corner = 0;
    for (const Triangle& t : input_->triangles) {
      for (std::uint32_t k = 0; k < 3; ++k) by_vertex_[first_[vertex_of_corner(t.v[k]) + 1]++] = corner + k;
      corner += 4;
    }
  };
  const Id* wedge_vertex = input_->wedges.vertex.data();
  if (has_wedges_)
    list([&](Id id) { return wedge_vertex[id]; });
  else
    list([](Id id) { return id; });
}

void RingMesh::make_rings(std::size_t begin, std::size_t end, RingArena& arena, ChainFan chain) {
  for (std::size_t v = begin; v < end; ++v) {
    const Vec3f p = input_->positions[v];
    points_[v] = {p.x, p.y, p.z, 0};
    const std::span<const std::uint32_t> corners = corners_of(v);
    if (const std::size_t ahead = v + vertices_ahead; ahead < end)
      for (const std::uint32_t corner : corners_of(ahead)) prefetch(&input_->triangles[corner / 4]);
    rings_[v].clear();
    if (corners.empty()) continue;
    several_[v] = make_simple_ring(static_cast<Id>(v), corners, arena, chain) ? 0 : 1;
  }
}

// The ring of a single fan; false for the others, which need a closer look.
bool RingMesh::make_simple_ring(Id v, std::span<const std::uint32_t> corners, RingArena& arena, ChainFan chain) {
  const auto n = static_cast<std::uint32_t>(corners.size());
  if (n > most_chained) return false;
  Id start[most_chained], end[most_chained];
  std::uint8_t order[most_chained] = {};
  // Eight where there are fewer: the end of a loop of any number cannot be predicted.
  const auto take = [&, from = corners.data()](auto&& vertex_of) {
    for (std::uint32_t k = 0; k < std::max(n, 8u); ++k) {
      const Triangle& t = input_->triangles[from[k] / 4];
      start[k] = vertex_of(t.v[after(from[k]) % 4]), end[k] = vertex_of(t.v[before(from[k]) % 4]);
    }
  };
  if (has_wedges_)
    take([&](Id id) { return input_->wedges.vertex[id]; });
  else
    take(std::identity{});
  const Shape shape = (n <= 8 ? chain : chain_fan)(start, end, n, order);
  if (shape == Shape::several) return false;
  const bool open = shape == Shape::open;
  Ring& ring = begin_ring(v, n, open, arena);
  for (std::uint32_t k = 0; k < (has_wedges_ ? n : std::max(n, 8u)); ++k) ring.ids[k] = start[order[k]];
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

// Makes a ring from corners as they are now, on copies where the surface was cut.
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
  if (!has_wedges_ && ring.size <= Ring::own_ids) return ring;
  constexpr std::uint32_t spare = 2;  // to begin with
  ring.capacity = (ring.size + spare) & 0x7fff'ffffu;
  ring.ids = arena.take(std::size_t{ring.capacity} * (has_wedges_ ? 2 : 1));
  return ring;
}

}  // namespace lodestone::progressive
