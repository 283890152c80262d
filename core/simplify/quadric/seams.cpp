#include "core/simplify/quadric/seams.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace lodestone::quadric {
namespace {

constexpr std::uint32_t no_record = 0xffff'ffffu;

unsigned degree_of(const Ring& ring) {
  unsigned n = 0;
  while (ring.lane[n] != none) ++n;
  return n;
}

unsigned lane_of(const Ring& ring, Id x) {
  unsigned lane = 0;
  while (ring.lane[lane] != x) ++lane;
  return lane;
}

}  // namespace

unsigned Seams::Record::find(Id x) const {
  return static_cast<unsigned>(std::find(neighbour, neighbour + count, x) - neighbour);
}

void Seams::reset(const SimplifyInput& input, Arrays& arrays) {
  to_.resize(input.wedge_vertex.size());
  std::iota(to_.begin(), to_.end(), 0u);
  record_of_.assign(input.positions.size(), no_record);
  records_.clear();
  find_candidates(input);
  gather_corners(input);
  for (std::size_t v = 0; v < input.positions.size(); ++v)
    if (several_[v] != 0) make_record(static_cast<Id>(v), arrays.ring[v]);
}

// Vertices with several wedges, and their neighbours: no others can be at the end of a seam.
void Seams::find_candidates(const SimplifyInput& input) {
  wedge_.assign(input.positions.size(), no_wedge);
  several_.assign(input.positions.size(), 0);
  for (std::size_t t = 0; t < input.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = input.triangles[t].v[k], w = input.corners[t].v[k];
      if (wedge_[v] == no_wedge) wedge_[v] = w;
      if (wedge_[v] != w) several_[v] = 2;
    }
  for (const Triangle& t : input.triangles)
    if (((several_[t.v[0]] | several_[t.v[1]] | several_[t.v[2]]) & 2) != 0)
      for (const std::uint32_t v : t.v) several_[v] |= 1;
  // A vertex without triangles can still have a wedge.
  for (std::uint32_t w = 0; w < input.wedge_vertex.size(); ++w)
    if (wedge_[input.wedge_vertex[w]] == no_wedge) wedge_[input.wedge_vertex[w]] = w;
}

void Seams::gather_corners(const SimplifyInput& input) {
  candidate_.resize(input.positions.size());
  first_.assign(1, 0);
  for (std::size_t v = 0; v < input.positions.size(); ++v) {
    if (several_[v] == 0) continue;
    candidate_[v] = static_cast<std::uint32_t>(first_.size()) - 1;
    first_.push_back(0);
  }
  const auto for_each_corner = [&](const auto& visit) {
    for (std::size_t t = 0; t < input.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        if (several_[input.triangles[t].v[k]] != 0) visit(t, k, (k + 1) % 3, (k + 2) % 3);
  };
  for_each_corner([&](std::size_t t, std::size_t k, std::size_t, std::size_t) {
    ++first_[candidate_[input.triangles[t].v[k]] + 1];
  });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  corners_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for_each_corner([&](std::size_t t, std::size_t k, std::size_t from, std::size_t to) {
    const auto &v = input.triangles[t].v, &w = input.corners[t].v;
    corners_[next[candidate_[v[k]]]++] = {
        static_cast<Id>(v[k]), static_cast<Id>(v[from]), static_cast<Id>(v[to]), w[k], w[from], w[to]};
  });
}

const Seams::Corner* Seams::corner_of(Id v, Id from, Id to) const {
  const auto end = corners_.begin() + first_[candidate_[v] + 1];
  const auto found = std::find_if(corners_.begin() + first_[candidate_[v]], end,
                                  [&](const Corner& c) { return c.from == from && c.to == to; });
  return found == end ? nullptr : &*found;
}

// Walks around the fan once. Vertices whose neighbours have no order are kept, and so are those with too many seams.
void Seams::make_record(Id v, Ring& ring) {
  const auto set = [&](Flags f) { ring.lane[flags_lane] = static_cast<Id>(ring.lane[flags_lane] | f); };
  const auto seal = [&] {
    set(sealed);
    ring.lane[flags_lane] = static_cast<Id>(ring.lane[flags_lane] & ~(movable | queued));
  };
  if (ring.has(nonmanifold)) return seal();
  const unsigned n = degree_of(ring);
  const bool open = ring.has(quadric::open);
  const unsigned triangles = open ? n - 1 : n;
  Record record;
  record.open = open;
  for (unsigned k = 0; k < triangles; ++k) {
    const Corner& now = *corner_of(v, ring.lane[k], ring.lane[k + 1 < n ? k + 1 : 0]);
    if (k == 0 && open) {
      record.first = now.wedge;
      continue;
    }
    const Corner& before = *corner_of(v, ring.lane[k > 0 ? k - 1 : n - 1], ring.lane[k]);
    if (before.wedge == now.wedge && before.to_wedge == now.from_wedge) continue;
    if (record.count == most_seams) return seal();
    record.neighbour[record.count] = ring.lane[k];
    record.after[record.count++] = now.wedge;
  }
  if (record.count == 0) return;
  record_of_[v] = static_cast<std::uint32_t>(records_.size());
  records_.push_back(record);
  set(seamed);
}

unsigned Seams::lanes(Id v, const Ring& ring, unsigned degree) const {
  const Record& record = records_[record_of_[v]];
  if (record.open || record.count != 2 || record.after[0] == record.after[1]) return 0;
  unsigned bits = 0;
  for (unsigned k = 0; k < degree; ++k)
    if (record.find(ring.lane[k]) < record.count) bits |= 1u << k;
  return bits;
}

bool Seams::allows(Id v, Id u) const {
  const Record& record = records_[record_of_[v]];
  const Id other = record.neighbour[record.neighbour[0] == u ? 1 : 0];
  if (record_of_[u] == no_record || record_of_[other] == no_record) return false;
  const Record &target = records_[record_of_[u]], &beyond = records_[record_of_[other]];
  // The seam must neither close over a chart of one triangle, nor heal because both its ends have one wedge.
  if (target.find(other) != target.count) return false;
  const auto is_tip = [](const Record& r) { return r.count == 1 && !r.open; };
  return !is_tip(target) || !is_tip(beyond);
}

// The wedge of u on the counter-clockwise side of a lane of its ring.
std::uint32_t Seams::sector(Id u, unsigned lane, const Ring& ring) const {
  if (record_of_[u] == no_record) return wedge_[u];
  const Record& record = records_[record_of_[u]];
  const unsigned n = degree_of(ring);
  for (unsigned k = lane;; k = k > 0 ? k - 1 : n - 1) {
    if (const unsigned seam = record.find(ring.lane[k]); seam < record.count) return record.after[seam];
    if (record.open && k == 0) return record.first;
  }
}

void Seams::collapse(Id v, Id u, const Arrays& arrays) {
  const Ring& ring = arrays.ring[u];
  if (record_of_[v] == no_record) {
    if (record_of_[u] == no_record) {
      to_[wedge_[v]] = wedge_[u];
      return;
    }
    const unsigned lane = lane_of(ring, v);
    // There is no triangle after the last neighbour of an open fan.
    const bool last = records_[record_of_[u]].open && lane + 1 == degree_of(ring);
    to_[wedge_[v]] = sector(u, last ? lane - 1 : lane, ring);
    return;
  }
  Record& record = records_[record_of_[v]];
  const unsigned along = record.neighbour[0] == u ? 0 : 1;
  const Id other = record.neighbour[1 - along];
  const unsigned lane = lane_of(ring, v), before = lane > 0 ? lane - 1 : degree_of(ring) - 1;
  // The side that is counter-clockwise of the seam for v is clockwise of it for u.
  to_[record.after[along]] = sector(u, before, ring);
  to_[record.after[1 - along]] = sector(u, lane, ring);
  Record& target = records_[record_of_[u]];
  target.neighbour[target.find(v)] = other;
  Record& beyond = records_[record_of_[other]];
  beyond.neighbour[beyond.find(v)] = u;
}

// Chains of collapses are followed to their end. A wedge that no triangle of the block uses follows its vertex.
void Seams::resolve(const SimplifyInput& input, const std::vector<std::uint32_t>& parent,
                    std::vector<std::uint32_t>& wedge_parent) {
  wedge_parent.resize(to_.size());
  for (std::uint32_t w = 0; w < to_.size(); ++w) {
    std::uint32_t end = w;
    while (to_[end] != end) end = to_[end];
    for (std::uint32_t at = w; at != end;) at = std::exchange(to_[at], end);
    const std::uint32_t vertex = parent[input.wedge_vertex[w]];
    wedge_parent[w] = input.wedge_vertex[end] == vertex ? end : wedge_[vertex];
  }
}

}  // namespace lodestone::quadric
