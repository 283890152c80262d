// All wedges of a vertex meet at the rank of its number. A wedge is named by its key: those of a rank follow each
// other, first the ones of the file, then the copies that several materials need. In the order of all wedges every copy
// is after all that are none.
#include "parallel/distributed/distributed_wedges.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/base/error.h"
#include "core/hierarchy/construct/finest_cell.h"
#include "parallel/clean/find_repeats.h"
#include "parallel/clean/prepare_wedges.h"
#include "parallel/distributed/held_stream.h"
#include "parallel/distributed/messages/pieces.h"

namespace lodestone {
namespace {

constexpr std::uint32_t none = 0xffff'ffffu;

// The place of a wedge in the order of all.
class WedgeOrder {
 public:
  WedgeOrder() = default;
  WedgeOrder(std::uint64_t key, bool is_copy) : value_(key | (is_copy ? copy_bit : 0)) {}
  [[nodiscard]] std::uint32_t key() const { return static_cast<std::uint32_t>(value_); }
  friend auto operator<=>(const WedgeOrder&, const WedgeOrder&) = default;

 private:
  static constexpr std::uint64_t copy_bit = std::uint64_t{1} << 32;
  std::uint64_t value_ = 0;
};

struct WedgeItem {
  WedgeValues key;
  WedgeOrder number;
};
using WedgeRepeat = Repeat<WedgeOrder>;

class WedgeWelding {
 public:
  WedgeWelding(RankSurface&& surface, const MeshStream& stream, CleanSlices& clean, Ranks& ranks, Scheduler& scheduler)
      : wedges_(std::move(surface.own)),
        count_(surface.wedges),
        originals_(surface.wedges),
        stream_(stream),
        clean_(clean),
        ranks_(ranks),
        scheduler_(scheduler) {
    out_.kinds = surface.kinds;
    out_.vertices = clean.vertices_left;
  }

  // Leaves the triangles that are clean, and finds the vertex of each wedge that these use.
  void place() {
    std::vector<Triangle> triangles(clean_.triangles.size(ranks_.rank()));
    stream_.read_triangles(clean_.triangles.begin(ranks_.rank()), triangles);
    const auto keep = [&](auto& items) {
      std::size_t kept = 0;
      for (std::size_t t = 0; t < items.size(); ++t)
        if (!clean_.dropped[t]) items[kept++] = items[t];
      items.resize(kept);
    };
    keep(triangles), keep(wedges_.corners), keep(wedges_.material);
    make_finite(wedges_);
    out_.kinds.materials = ranks_.any(std::ranges::any_of(wedges_.material, [](std::uint32_t m) { return m != 0; }));
    if (out_.kinds.materials) material_ = give_materials(wedges_, count_);
    vertex_.assign(count_, none);
    const std::uint64_t first = clean_.vertices.begin(ranks_.rank());
    slice_vertex_.assign(count_, 0);
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t wedge = wedges_.corners[t].v[k];
        slice_vertex_[wedge] = static_cast<std::uint32_t>(triangles[t].v[k] - first);
        vertex_[wedge] = clean_.numbers[slice_vertex_[wedge]];
      }
  }

  void weld() {
    keys_ = Slices(ranks_.gather(std::uint64_t{count_}));
    if (keys_.total() > none) throw ResourceError(describe(stream_.name(), "", "more vertices than 32-bit ids reach"));
    std::vector<WedgeItem> items;
    exchange_in_pieces<WedgeItem>(
        ranks_, count_,
        [&](std::uint64_t w, const auto& emit) {
          if (vertex_[w] != none) emit(out_.vertices.owner(vertex_[w]), {values(w), order(w)});
        },
        [&](int, const std::vector<WedgeItem>& some) { items.insert(items.end(), some.begin(), some.end()); });
    const std::vector<WedgeRepeat> repeats = repeats_among(items, scheduler_);
    std::vector<WedgeItem>().swap(items);
    become_.resize(count_);
    for (std::uint64_t w = 0; w < count_; ++w) become_[w] = order(w);
    exchange_in_pieces<WedgeRepeat>(
        ranks_, repeats.size(),
        [&](std::uint64_t i, const auto& emit) { emit(keys_.owner(repeats[i].repeat.key()), repeats[i]); },
        [&](int, const std::vector<WedgeRepeat>& some) {
          for (const WedgeRepeat& r : some) become_[r.repeat.key() - keys_.begin(ranks_.rank())] = r.first;
        });
  }

  // Those that are left are numbered through all ranks, copies last; the others get the number of what they have
  // become.
  void number() {
    numbers_.assign(count_, none);
    const auto left_in = [&](std::uint64_t begin, std::uint64_t end) {
      std::uint64_t left = 0;
      for (std::uint64_t w = begin; w < end; ++w) left += is_left(w);
      return ranks_.gather(left);
    };
    const std::vector<std::uint64_t> originals = left_in(0, originals_), copies = left_in(originals_, count_);
    out_.wedges = Slices(originals, copies);
    if (out_.wedges.total() >= FinestVertices::shared_flag)
      throw ResourceError(describe(stream_.name(), "", "has more than 2^31 vertices; vertex ids have 32 bits"));
    std::uint64_t original = Slices(originals).begin(ranks_.rank());
    std::uint64_t copy = Slices(originals).total() + Slices(copies).begin(ranks_.rank());
    for (std::uint64_t w = 0; w < count_; ++w)
      if (is_left(w)) numbers_[w] = static_cast<std::uint32_t>(w < originals_ ? original++ : copy++);
    std::vector<std::uint32_t> others;
    for (std::uint32_t w = 0; w < count_; ++w)
      if (vertex_[w] != none && !is_left(w)) others.push_back(w);
    for_pieces(ranks_, others.size(), [&](std::uint64_t begin, std::uint64_t end) {
      std::vector<std::uint32_t> keys;
      for (std::uint64_t i = begin; i < end; ++i) keys.push_back(become_[others[i]].key());
      const auto numbers =
          Question(ranks_, keys_, keys).answer<std::uint32_t>([&](std::uint32_t w) { return numbers_[w]; });
      for (std::uint64_t i = begin; i < end; ++i) numbers_[others[i]] = numbers[i - begin];
    });
  }

  // Those that are left remain where they have been read.
  void keep() {
    std::vector<Vec3f> positions;
    clean_.numbers.clear();
    for (std::uint64_t w = 0; w < count_; ++w) {
      if (!is_left(w)) continue;
      positions.push_back(clean_.positions[slice_vertex_[w]]);
      clean_.numbers.push_back(numbers_[w]);
      out_.values.push_back(values(w));
    }
    clean_.positions = std::move(positions);
  }

  [[nodiscard]] WedgeSlices result() && {
    std::vector<Triangle> triangles = std::move(wedges_.corners);
    for (Triangle& t : triangles)
      for (std::uint32_t& w : t.v) w = numbers_[w];
    clean_.triangles = Slices(ranks_.gather(clean_.own_triangles));
    clean_.dropped = BitSet(triangles.size());
    clean_.vertices = clean_.vertices_left = out_.wedges;
    clean_.left.assign(out_.values.size(), 1);
    out_.triangles = std::make_shared<HeldStream>(
        stream_.name(), HeldFigures{out_.wedges.total(), clean_.triangles_left, stream_.up()},
        HeldStream::Part<Vec3d>{},
        HeldStream::Part<Triangle>{clean_.triangles.begin(ranks_.rank()), std::move(triangles)});
    return std::move(out_);
  }

 private:
  [[nodiscard]] WedgeOrder order(std::uint64_t w) const { return {keys_.begin(ranks_.rank()) + w, w >= originals_}; }
  [[nodiscard]] bool is_left(std::uint64_t w) const { return vertex_[w] != none && become_[w] == order(w); }
  [[nodiscard]] WedgeValues values(std::uint64_t w) const {
    const auto of = [&](const auto& items) {
      using Value = typename std::decay_t<decltype(items)>::value_type;
      return items.empty() ? Value{} : items[w];
    };
    return {vertex_[w], of(material_), of(wedges_.colour), of(wedges_.uv), of(wedges_.normal)};
  }

  RawWedges wedges_;
  std::size_t count_, originals_;  // own wedges: with copies, and without
  const MeshStream& stream_;
  CleanSlices& clean_;
  Ranks& ranks_;
  Scheduler& scheduler_;
  WedgeSlices out_;
  std::vector<std::uint32_t> material_;      // by own wedge; empty if all have the first
  std::vector<std::uint32_t> vertex_;        // by own wedge: its vertex, or none if no triangle uses it
  std::vector<std::uint32_t> slice_vertex_;  // by own wedge: a vertex of the slice that has become that
  Slices keys_;
  std::vector<WedgeOrder> become_;      // by own wedge
  std::vector<std::uint32_t> numbers_;  // by own wedge
};

}  // namespace

std::uint64_t hash_of(const WedgeValues& w) {
  const auto mixed = [](std::uint64_t h, std::uint32_t low, std::uint32_t high) {
    h = (h ^ (low | std::uint64_t{high} << 32)) * 0x9e37'79b9'7f4a'7c15ull;
    return h ^ (h >> 29);
  };
  const auto bits = [](const auto& value) { return std::bit_cast<std::uint32_t>(value); };
  std::uint64_t h = mixed(0, w.vertex, w.material);
  h = mixed(h, bits(w.uv.x), bits(w.uv.y));
  h = mixed(h, bits(w.normal.x), bits(w.normal.y));
  h = mixed(h, bits(w.normal.z), bits(w.colour));
  return mixed(h, 1, 0);
}

WedgeSlices weld_wedges(RankSurface&& surface, const MeshStream& stream, CleanSlices& clean, Ranks& ranks,
                        Scheduler& scheduler) {
  ranks.begin("welding attributes");
  WedgeWelding welding(std::move(surface), stream, clean, ranks, scheduler);
  welding.place();
  welding.weld();
  welding.number();
  welding.keep();
  return std::move(welding).result();
}

void attach_wedges(WedgeSlices&& given, RoutedMesh& routed, Ranks& ranks) {
  const WedgeSlices slices = std::move(given);
  WedgeAttributes& out = routed.mesh.wedges;
  KeyNumbers<std::uint32_t> vertices;
  vertices.clear(routed.ids.size());
  std::vector<std::uint32_t> first;  // by vertex: its first wedge
  ranks.begin("fetching attributes");
  for_pieces(ranks, routed.ids.size(), [&](std::uint64_t begin, std::uint64_t end) {
    const Question question(ranks, slices.wedges, std::span(routed.ids).subspan(begin, end - begin));
    for (const WedgeValues& w :
         question.answer<WedgeValues>([&](std::uint32_t wedge) { return slices.values[wedge]; })) {
      const std::uint32_t vertex = vertices.number(w.vertex);
      if (vertex == first.size()) first.push_back(static_cast<std::uint32_t>(out.vertex.size()));
      out.vertex.push_back(first[vertex]);
      routed.vertex_ids.push_back(w.vertex);
      if (slices.kinds.uv) out.uv.push_back(w.uv);
      if (slices.kinds.colours) out.colour.push_back(w.colour);
      if (slices.kinds.normals) out.normal.push_back(w.normal);
      if (slices.kinds.materials) out.material.push_back(w.material);
    }
  });
  ranks.begin("finding shared vertices");
  const std::vector<std::uint8_t> used = asked_by_others(slices.vertices, vertices.keys(), ranks);
  routed.vertices = slices.vertices;
  routed.used_by_others.assign(routed.ids.size(), 0);
  for (std::size_t v = 0; v < first.size(); ++v) routed.used_by_others[first[v]] = used[v];
}

}  // namespace lodestone
