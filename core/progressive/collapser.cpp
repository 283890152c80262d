// A binary heap that is looked after lazily: a collapse only marks the vertices around it, and a marked vertex is
// looked at again when it comes up. Ties are broken by the number of the vertex.
#include "core/progressive/collapser.h"

#include <algorithm>
#include <limits>

namespace lodestone::progressive {
namespace {

constexpr float never = std::numeric_limits<float>::infinity();
constexpr std::uint8_t dirty = 1, queued = 2, member = 4;

struct Entry {
  float rank;
  Id vertex;
  // Of a heap whose top is the lowest.
  friend bool operator<(const Entry& a, const Entry& b) {
    return a.rank != b.rank ? a.rank > b.rank : a.vertex > b.vertex;
  }
};

}  // namespace

class Collapser::Queue {
 public:
  void fill(std::vector<Entry>&& entries) {
    entries_ = std::move(entries);
    std::make_heap(entries_.begin(), entries_.end());
  }
  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] float lowest() const { return entries_.empty() ? never : entries_.front().rank; }
  void push(Entry entry) {
    entries_.push_back(entry);
    std::push_heap(entries_.begin(), entries_.end());
  }
  Id pop() {
    std::pop_heap(entries_.begin(), entries_.end());
    const Id vertex = entries_.back().vertex;
    entries_.pop_back();
    return vertex;
  }

 private:
  std::vector<Entry> entries_;
};

Collapser::Collapser(RingMesh& rings, CollapseMetric& metric)
    : rings_(rings),
      metric_(metric),
      rank_(rings.vertex_count(), never),
      target_(rings.vertex_count(), no_id),
      parent_(rings.vertex_count(), no_id),
      state_(rings.vertex_count(), 0) {}

void Collapser::start(std::size_t begin, std::size_t end) {
  for (std::size_t v = begin; v < end; ++v)
    if (rings_.is_used(static_cast<Id>(v))) look(static_cast<Id>(v));
}

// Whether a triangle around v that stays would turn by 60 degrees or more, or lose its area.
bool Collapser::turns(const Collapse& c) const {
  constexpr float least_cosine = 0.5f;
  const Ring& ring = rings_.ring(c.vertex);
  const Vec3f from = rings_.position(c.vertex), to = rings_.position(c.target);
  for (std::uint32_t k = 0; k < ring.sectors(); ++k) {
    const Id first = ring.ids[k], second = ring.ids[ring.next(k)];
    if (first == c.target || second == c.target) continue;
    const Vec3f a = rings_.position(first), b = rings_.position(second);
    const Vec3f before = cross(a - from, b - from), after = cross(a - to, b - to);
    const float along = dot(before, after), size = dot(before, before);
    if (size > 0 && !(along > 0 && along * along > least_cosine * least_cosine * size * dot(after, after))) return true;
  }
  return false;
}

// Finds the cheapest neighbour that v may collapse into.
void Collapser::look(Id v) {
  state_[v] = static_cast<std::uint8_t>(state_[v] & ~dirty);
  rank_[v] = never;
  const Ring& ring = rings_.ring(v);
  if (ring.size > CollapseMetric::most_neighbours) return;
  float ranks[CollapseMetric::most_neighbours];
  metric_.rank(v, {ranks, ring.size});
  while (true) {
    const auto best = static_cast<std::uint32_t>(std::min_element(ranks, ranks + ring.size) - ranks);
    if (!(ranks[best] < never)) return;
    Collapse collapse{.vertex = v, .target = ring.ids[best]};
    if (rings_.allows(collapse) && !turns(collapse) && metric_.allows(collapse)) {
      rank_[v] = ranks[best];
      target_[v] = collapse.target;
      return;
    }
    ranks[best] = never;
  }
}

std::vector<CollapseRecord> Collapser::run(const Region& region, RingArena& arena) {
  std::vector<CollapseRecord> records;
  std::vector<Entry> entries;
  for (const Id v : region.vertices) {
    state_[v] |= member;
    const bool maybe = rank_[v] == never && (state_[v] & dirty) != 0;  // could not collapse, but things have changed
    if (rank_[v] > region.most_rank && !maybe) continue;
    entries.push_back({maybe ? 0 : rank_[v], v});
    state_[v] |= queued;
  }
  Queue queue;
  queue.fill(std::move(entries));
  float order = 0;
  std::size_t gone = 0;
  while (!queue.empty() && gone < region.most_triangles) {
    const Id v = queue.pop();
    state_[v] = static_cast<std::uint8_t>(state_[v] & ~queued);
    if ((state_[v] & dirty) != 0) {
      look(v);
      if (rank_[v] > std::min(region.most_rank, std::numeric_limits<float>::max())) continue;
      if (rank_[v] > queue.lowest()) {
        queue.push({rank_[v], v});
        state_[v] |= queued;
        continue;
      }
    }
    CollapseRecord record;
    if (!(rank_[v] < never) || !collapse(v, queue, arena, record)) continue;
    order = std::max(order, rank_[v]);
    record.order = order;
    gone += record.triangles;
    records.push_back(record);
  }
  for (const Id v : region.vertices) state_[v] = static_cast<std::uint8_t>(state_[v] & ~(member | queued));
  return records;
}

// The collapse of v as it was last looked at; when the rings around it do not allow that any more, v is looked at anew
// and goes back into the queue.
bool Collapser::collapse(Id v, Queue& queue, RingArena& arena, CollapseRecord& record) {
  Collapse collapse{.vertex = v, .target = target_[v]};
  if (!rings_.allows(collapse)) {
    look(v);
    if (rank_[v] < never) {
      queue.push({rank_[v], v});
      state_[v] |= queued;
    }
    return false;
  }
  const std::uint32_t size = rings_.ring(v).size;
  const Id* const ids = rings_.ring(v).ids;
  record.vertex = v;
  record.error = metric_.collapse(collapse);
  record.triangles = static_cast<std::uint32_t>(rings_.apply(collapse, arena));
  parent_[v] = collapse.target;
  if (rings_.has_wedges())
    for (const int side : {0, 1}) parent_[collapse.wedge[side]] = collapse.wedge_target[side];
  for (std::uint32_t k = 0; k < size; ++k) {
    const Id x = ids[k];
    state_[x] |= dirty;
    // One that could not collapse may be able to now.
    if (rank_[x] == never && (state_[x] & (member | queued)) == member) {
      state_[x] |= queued;
      queue.push({rank_[v], x});
    }
  }
  return true;
}

}  // namespace lodestone::progressive
