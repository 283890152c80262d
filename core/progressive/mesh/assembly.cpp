#include "core/progressive/mesh/assembly.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/progressive/mesh/activation.h"
#include "core/progressive/mesh/flaps.h"

namespace lodestone::progressive {

// Wedges of each vertex, by number.
struct Assembly::WedgeLists {
  std::vector<Id> first, wedges;

  explicit WedgeLists(const RingMesh& rings) {
    const std::size_t count = rings.vertex_count();
    std::vector<bool> used(count);
    for (const Triangle& t : rings.corners())
      for (const Id w : t.v) used[w] = true;
    first.assign(count + 1, 0);
    for (Id w = 0; w < count; ++w)
      if (used[w]) ++first[rings.vertex_of(w) + 1];
    for (std::size_t v = 1; v <= count; ++v) first[v] += first[v - 1];
    wedges.resize(first.back());
    std::vector<Id> fill(first.begin(), first.end() - 1);
    for (Id w = 0; w < count; ++w)
      if (used[w]) wedges[fill[rings.vertex_of(w)]++] = w;
  }
  [[nodiscard]] std::span<const Id> of(Id v) const {
    return std::span(wedges).subspan(first[v], first[v + 1] - first[v]);
  }
};

Assembly::Assembly(const IndexedMesh& mesh, const RingMesh& rings, CollapseSequence&& sequence)
    : mesh_(mesh), rings_(rings), sequence_(std::move(sequence)) {}

void Assembly::cut_sequence() {
  std::size_t kept = 0;
  for (std::size_t left = mesh_.triangles.size(); kept < sequence_.records.size(); ++kept) {
    const std::size_t gone = sequence_.records[kept].triangles;
    if (left < sequence_.base_triangles + gone) break;
    left -= gone;
  }
  sequence_.records.resize(kept);
}

// The vertices that are left, by number, but none beside a copy of itself, where it would look like its wedge: it takes
// the first place it can. There is one, unless more than half of the vertices are copies of one.
std::vector<Id> Assembly::base_order(const std::vector<bool>& gone) const {
  const auto alike = [&](Id v, Id w) { return rings_.original_of(v) == rings_.original_of(w); };
  std::vector<Id> base, waiting;
  for (Id v = 0; v < rings_.vertex_count(); ++v) {
    if (rings_.vertex_of(v) != v || gone[v] || (!rings_.is_used(v) && sequence_.parents[v] == no_id)) continue;
    if (!base.empty() && alike(base.back(), v)) {
      waiting.push_back(v);
      continue;
    }
    base.push_back(v);
    if (waiting.empty() || alike(waiting.back(), v)) continue;
    base.push_back(waiting.back());
    waiting.pop_back();
  }
  for (const Id v : waiting) {
    std::size_t at = 0;
    while (at < base.size() && (alike(base[at], v) || (at > 0 && alike(base[at - 1], v)))) ++at;
    base.insert(base.begin() + static_cast<std::ptrdiff_t>(at), v);
  }
  return base;
}

// The base, then the collapsed vertices, last first.
void Assembly::order() {
  cut_sequence();
  std::vector<bool> gone(rings_.vertex_count());
  float error = 0;
  for (CollapseRecord& r : sequence_.records) {
    gone[r.vertex] = true;
    r.error = error = std::max(error, r.error);
  }
  number_.assign(rings_.vertex_count(), no_id);
  wedges_.reserve(rings_.vertex_count());
  out_.errors.reserve(rings_.vertex_count());
  const auto add = [&](Id w, float e) {
    number_[w] = static_cast<Id>(wedges_.size());
    wedges_.push_back(w);
    out_.errors.push_back(e);
  };
  std::optional<WedgeLists> lists;
  if (rings_.has_wedges()) lists.emplace(rings_);
  const auto add_vertex = [&](Id v, float e) {
    if (!lists) return add(v, e);
    for (const Id w : lists->of(v)) add(w, e);
  };
  for (const Id v : base_order(gone)) add_vertex(v, error);
  out_.base_vertices = static_cast<std::uint32_t>(wedges_.size());
  if (lists)
    for (std::size_t k = sequence_.records.size(); k-- > 0;)
      add_vertex(sequence_.records[k].vertex, sequence_.records[k].error);
  else
    wedges_.resize(wedges_.size() + sequence_.records.size()), out_.errors.resize(wedges_.size());
}

// Without wedges every collapse is one vertex, and its number is known.
void Assembly::number(std::size_t begin, std::size_t end) {
  if (rings_.has_wedges()) return;
  for (std::size_t k = begin; k < end; ++k) {
    const CollapseRecord& record = sequence_.records[k];
    const std::size_t place = wedges_.size() - 1 - k;
    number_[record.vertex] = static_cast<Id>(place);
    wedges_[place] = record.vertex;
    out_.errors[place] = record.error;
  }
}

void Assembly::make_room(ProgressiveMesh&& room) {
  out_.positions = std::move(room.positions);
  out_.parents = std::move(room.parents);
  out_.triangles = std::move(room.triangles);
  const auto like = [&]<class T>(std::vector<T>& to, const std::vector<T>& from) {
    if (!from.empty()) to.resize(wedges_.size());
  };
  out_.positions.resize(wedges_.size());
  out_.parents.resize(wedges_.size());
  like(out_.wedges.uv, mesh_.wedges.uv);
  like(out_.wedges.colour, mesh_.wedges.colour);
  like(out_.wedges.normal, mesh_.wedges.normal);
  like(out_.wedges.material, mesh_.wedges.material);
  out_.transform = mesh_.transform;
  out_.triangles.resize(mesh_.triangles.size());
  mapped_ = std::make_unique_for_overwrite<Triangle[]>(mesh_.triangles.size());
  activations_ = std::make_unique_for_overwrite<std::uint32_t[]>(mesh_.triangles.size());
}

void Assembly::gather(std::size_t begin, std::size_t end) {
  const auto pick = [&]<class T>(std::vector<T>& to, const std::vector<T>& from) {
    if (from.empty()) return;
    for (std::size_t k = begin; k < end; ++k) to[k] = from[rings_.source_of(wedges_[k])];
  };
  pick(out_.positions, mesh_.positions);
  pick(out_.wedges.uv, mesh_.wedges.uv);
  pick(out_.wedges.colour, mesh_.wedges.colour);
  pick(out_.wedges.normal, mesh_.wedges.normal);
  pick(out_.wedges.material, mesh_.wedges.material);
  for (std::size_t k = std::max<std::size_t>(begin, out_.base_vertices); k < end; ++k)
    out_.parents[k] = number_[sequence_.parents[wedges_[k]]];
}

void Assembly::find_groups() {
  groups_ = group_starts(out_);
  ancestors_ = std::make_unique_for_overwrite<Ancestor[]>(number_.size());
}

void Assembly::find_ancestors(std::size_t begin, std::size_t end) {
  for (std::size_t w = begin; w < end; ++w)
    if (const Id number = number_[w]; number != no_id)
      ancestors_[w] = Ancestor{groups_[number]} << 32 | sequence_.parents[w];
}

// As activation_of (activation.h), by the wedges of the rings: those of a triangle and their parents are near each
// other in the input and so in memory, by new number they are anywhere.
Id Assembly::activation_of(const Triangle& corners) const {
  const auto group = [](Ancestor x) { return static_cast<Id>(x >> 32); };
  const auto alike = [&](Ancestor x, Ancestor y) { return group(x ^ y) == 0; };
  Ancestor a = ancestors_[corners.v[0]], b = ancestors_[corners.v[1]], c = ancestors_[corners.v[2]];
  if (alike(a, b) || alike(b, c) || alike(c, a)) return static_cast<Id>(vertex_count());
  while (true) {
    const Ancestor most = a < b ? b : a, less = a ^ b ^ most;
    a = most < c ? c : most, b = most ^ c ^ a, c = less;
    if (group(a) < out_.base_vertices) return 0;
    const Ancestor next = ancestors_[static_cast<Id>(a)];
    if (alike(next, b) || alike(next, c)) return group(a);
    a = next;
  }
}

void Assembly::map_triangles(std::size_t begin, std::size_t end) {
  const std::span<const Triangle> all = rings_.corners();
  for (std::size_t t = begin; t < end; ++t) {
    const Triangle& corners = all[t];
    mapped_[t] = {number_[corners.v[0]], number_[corners.v[1]], number_[corners.v[2]]};
    activations_[t] = activation_of(corners);
  }
}

ProgressiveMesh Assembly::finish() {
  delay_flaps(out_, groups_, {mapped_.get(), out_.triangles.size()}, {activations_.get(), out_.triangles.size()});
  sort_by_activation({mapped_.get(), out_.triangles.size()}, {activations_.get(), out_.triangles.size()},
                     vertex_count(), out_.triangles.data());
  return std::move(out_);
}

}  // namespace lodestone::progressive
