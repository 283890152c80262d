// Vertices and triangles remain in the slices of the ranks that read them. What a triangle needs to know of its corners
// it asks the ranks that have them, piece by piece. Equal vertices, and equal triangles, meet at a rank that follows
// from their bits; those that cannot equal any of another rank, which are most where the input has an order, at their
// own.
#include "parallel/distributed/distributed_clean.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/mesh/clean.h"
#include "core/mesh/clean_kernels.h"
#include "parallel/distributed/shared_places.h"

namespace lodestone {
namespace {

// A vertex that is used, and its number.
struct WeldItem {
  Vec3f key;
  std::uint32_t number;
};

// A triangle by its vertices in cyclic order from the smallest on, and its number.
struct TriangleItem {
  Triangle key;
  std::uint32_t number;
};

using NumberRepeat = Repeat<std::uint32_t>;

// By whom a vertex is used.
class Users {
 public:
  void add(int rank) {
    const auto user = static_cast<std::uint16_t>(std::min(rank + 1, int{several}));
    only_ = only_ == none || only_ == user ? user : several;
  }
  [[nodiscard]] bool others_than(int rank) const { return only_ == several || only_ != rank + 1; }

 private:
  static constexpr std::uint16_t none = 0, several = 0xffff;
  std::uint16_t only_ = none;  // or a rank, plus 1; ranks of higher numbers count as several
};

class DistributedCleaning {
 public:
  DistributedCleaning(const RankInput& input, std::uint64_t most_items, Ranks& ranks, Scheduler& scheduler)
      : stream_(*input.stream), most_items_(most_items), ranks_(ranks), scheduler_(scheduler) {
    out_.vertices = input.vertices;
    out_.triangles = input.triangles;
    out_.repairs = input.reading;
    first_vertex_ = out_.vertices.begin(ranks.rank());
    first_triangle_ = out_.triangles.begin(ranks.rank());
    own_vertices_ = out_.vertices.size(ranks.rank());
    own_triangles_ = out_.triangles.size(ranks.rank());
    out_.dropped = BitSet(own_triangles_);
    out_.transform.up = stream_.up();
    states_.resize(own_vertices_);
    if (ranks.count() > 1) users_.resize(own_vertices_);
  }

  void drop_non_finite_triangles() {
    std::uint64_t not_finite = 0;
    visit_vertices([&](std::uint64_t at, std::span<const Vec3d> positions) {
      not_finite += classify_vertices(positions, std::span(states_).subspan(at, positions.size()));
    });
    const bool all_finite = ranks_.sum(not_finite) == 0;
    std::uint64_t dropped = 0, degenerate = 0;
    visit_triangles([&](std::uint64_t at, std::span<const Triangle> triangles) {
      const PieceCorners corners(triangles);
      std::vector<std::uint8_t> bad(corners.vertices().size(), 0), used(bad.size(), 0);
      if (!all_finite)
        bad = Question(ranks_, out_.vertices, corners.vertices()).answer<std::uint8_t>([&](std::uint32_t v) {
          return std::uint8_t{states_[v] == VertexState::not_finite};
        });
      for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto& v = corners.of(t).v;
        const bool finite = (bad[v[0]] | bad[v[1]] | bad[v[2]]) == 0;
        if (finite) used[v[0]] = used[v[1]] = used[v[2]] = 1;
        dropped += !finite;
        degenerate += finite && is_degenerate(triangles[t]);
        if (!finite || is_degenerate(triangles[t])) out_.dropped.set(at + t);
      }
      mark_used(corners.vertices(), used);
    });
    out_.repairs.non_finite_triangles = ranks_.sum(dropped);
    out_.repairs.degenerate_triangles = ranks_.sum(degenerate);
    if (out_.repairs.non_finite_triangles == stream_.triangle_count())
      require_survivors({}, out_.repairs, stream_.name());
  }

  void normalise(Lattice lattice) {
    Box3d box;
    visit_vertices([&](std::uint64_t at, std::span<const Vec3d> positions) {
      extend_box(positions, std::span(states_).subspan(at, positions.size()), box);
    });
    Box3d all;
    for (const Box3d& of_rank : ranks_.gather(box)) all.extend(of_rank);
    const Up up = out_.transform.up;
    out_.transform = normalising_transform(all, stream_.name());
    out_.transform.up = up;
    out_.transform.lattice = resolve_lattice(lattice, {}, {}, 1);
    out_.positions.resize(own_vertices_);
    visit_vertices([&](std::uint64_t at, std::span<const Vec3d> positions) {
      normalise_vertices(out_.transform, positions, std::span(states_).subspan(at, positions.size()),
                         std::span(out_.positions).subspan(at, positions.size()));
    });
  }

  void weld_vertices() {
    const SharedPlaces shared(out_.positions, states_, out_.vertices.total(), ranks_);
    const std::uint64_t turns = turns_of(out_.vertices);
    for (std::uint64_t turn = 0; turn < turns; ++turn) weld_vertices(shared, turn, turns);
  }

  // Then the vertices in use are those of the triangles that are left.
  void drop_degenerate_triangles() {
    if (out_.repairs.welded_vertices + out_.repairs.degenerate_triangles + out_.repairs.non_finite_triangles == 0)
      return;
    std::ranges::fill(states_, VertexState::unused);
    std::ranges::fill(users_, Users());
    std::uint64_t degenerate = 0;
    visit_welded(
        [&](std::uint64_t at, const PieceCorners& corners, std::span<const std::uint32_t> become, std::size_t count) {
          std::vector<std::uint8_t> used(become.size(), 0);
          for (std::size_t t = 0; t < count; ++t) {
            if (out_.dropped[at + t]) continue;
            const auto& v = corners.of(t).v;
            if (is_degenerate(Triangle{{become[v[0]], become[v[1]], become[v[2]]}})) {
              ++degenerate;
              out_.dropped.set(at + t);
            } else {
              used[v[0]] = used[v[1]] = used[v[2]] = 1;
            }
          }
          mark_used(become, used);
        });
    out_.repairs.degenerate_triangles += ranks_.sum(degenerate);
    if (out_.repairs.degenerate_triangles + out_.repairs.non_finite_triangles == stream_.triangle_count())
      require_survivors({}, out_.repairs, stream_.name());
  }

  // Equal triangles that several ranks may have meet at the owner of one of their vertices, picked by all three: near
  // the rank of the triangle where the input has an order, and spread evenly where it has none.
  void drop_duplicate_triangles() {
    const std::uint64_t turns = turns_of(out_.triangles);
    for (std::uint64_t turn = 0; turn < turns; ++turn) drop_duplicate_triangles(turn, turns);
  }

  // Those that are left are numbered through all ranks; those that have become another one get its number.
  void number_vertices() {
    std::uint64_t left = 0;
    for (const VertexState state : states_) left += state == VertexState::used;
    const std::vector<std::uint64_t> sizes = ranks_.gather(left);
    out_.vertices_left = Slices(sizes);
    out_.repairs.unreferenced_vertices =
        stream_.vertex_count() - out_.vertices_left.total() - out_.repairs.welded_vertices;
    auto next = static_cast<std::uint32_t>(out_.vertices_left.begin(ranks_.rank()));
    const bool welded = out_.repairs.welded_vertices > 0;
    out_.left.resize(own_vertices_);
    out_.numbers.resize(own_vertices_);
    for (std::uint64_t i = 0; i < own_vertices_; ++i) {
      out_.left[i] = states_[i] == VertexState::used;
      if (out_.left[i])
        out_.numbers[i] = next++;
      else if (!welded)
        out_.numbers[i] = 0;
    }
    if (welded) number_moved();
  }

  [[nodiscard]] CleanSlices result() && {
    for (std::uint64_t t = 0; t < own_triangles_; ++t) out_.own_triangles += !out_.dropped[t];
    out_.triangles_left = ranks_.sum(out_.own_triangles);
    return std::move(out_);
  }

 private:
  // All ranks take as many turns to compare the items of such slices.
  [[nodiscard]] std::uint64_t turns_of(const Slices& slices) const {
    std::uint64_t most = 0;
    for (int r = 0; r < ranks_.count(); ++r) most = std::max(most, slices.size(r));
    return std::clamp<std::uint64_t>((most + most_items_ - 1) / most_items_, 1, most_turns);
  }

  // Equal positions meet at the rank of their hash. -0 and NaN do not occur any more.
  void weld_vertices(const SharedPlaces& shared, std::uint64_t turn, std::uint64_t turns) {
    std::vector<WeldItem> items;
    items.reserve((own_vertices_ + own_vertices_ / 16) / turns);  // growing would take it twice
    exchange_in_pieces<WeldItem>(
        ranks_, own_vertices_,
        [&](std::uint64_t i, const auto& emit) {
          if (states_[i] != VertexState::used) return;
          const std::uint64_t hash = hash_of(out_.positions[i]);
          if (turn_of_hash(hash, turns) == turn)
            emit(shared.contains(out_.positions[i]) ? rank_of_hash(hash, ranks_) : ranks_.rank(),
                 {out_.positions[i], static_cast<std::uint32_t>(first_vertex_ + i)});
        },
        [&](int, std::vector<WeldItem>&& some) { items.insert(items.end(), some.begin(), some.end()); });
    const std::vector<NumberRepeat> repeats = repeats_among(items, scheduler_);
    std::vector<WeldItem>().swap(items);
    const std::uint64_t welded = ranks_.sum(repeats.size());
    if (welded == 0) return;
    if (out_.repairs.welded_vertices == 0) {
      out_.numbers.resize(own_vertices_);
      for (std::uint64_t i = 0; i < own_vertices_; ++i) out_.numbers[i] = static_cast<std::uint32_t>(first_vertex_ + i);
    }
    out_.repairs.welded_vertices += welded;
    exchange_in_pieces<NumberRepeat>(
        ranks_, repeats.size(),
        [&](std::uint64_t i, const auto& emit) { emit(out_.vertices.owner(repeats[i].repeat), repeats[i]); },
        [&](int, const std::vector<NumberRepeat>& some) {
          for (const NumberRepeat& r : some) out_.numbers[r.repeat - first_vertex_] = r.first;
        });
  }

  void drop_duplicate_triangles(std::uint64_t turn, std::uint64_t turns) {
    std::vector<TriangleItem> items;
    items.reserve((own_triangles_ + own_triangles_ / 16) / turns);
    visit_welded(
        [&](std::uint64_t at, const PieceCorners& corners, std::span<const std::uint32_t> become, std::size_t count) {
          ByRank<TriangleItem> out = by_rank<TriangleItem>(ranks_);
          std::vector<std::pair<TriangleItem, Triangle>> elsewhere;  // with the corners
          std::vector<std::uint8_t> asked(become.size(), 0);
          for (std::size_t t = 0; t < count; ++t) {
            if (out_.dropped[at + t]) continue;
            const auto& c = corners.of(t).v;
            const Triangle key = canonical(Triangle{{become[c[0]], become[c[1]], become[c[2]]}});
            if (turn_of_hash(hash_of(key), turns) != turn) continue;
            const TriangleItem item{key, static_cast<std::uint32_t>(first_triangle_ + at + t)};
            if (meeting_rank(key) == ranks_.rank()) {
              out[static_cast<std::size_t>(ranks_.rank())].push_back(item);
            } else {
              elsewhere.emplace_back(item, corners.of(t));
              asked[c[0]] = asked[c[1]] = asked[c[2]] = 1;
            }
          }
          const std::vector<std::uint8_t> used = used_by_others(become, asked);
          for (const auto& [item, c] : elsewhere) {
            const bool may_meet = used[c.v[0]] && used[c.v[1]] && used[c.v[2]];
            out[static_cast<std::size_t>(may_meet ? meeting_rank(item.key) : ranks_.rank())].push_back(item);
          }
          for (const auto& some : ranks_.exchange(out)) items.insert(items.end(), some.begin(), some.end());
        });
    std::vector<std::uint32_t> repeats;
    for (const NumberRepeat& r : repeats_among(items, scheduler_)) repeats.push_back(r.repeat);
    std::vector<TriangleItem>().swap(items);
    out_.repairs.duplicate_triangles += ranks_.sum(repeats.size());
    exchange_in_pieces<std::uint32_t>(
        ranks_, repeats.size(),
        [&](std::uint64_t i, const auto& emit) { emit(out_.triangles.owner(repeats[i]), repeats[i]); },
        [&](int, const std::vector<std::uint32_t>& some) {
          for (const std::uint32_t t : some) out_.dropped.set(t - first_triangle_);
        });
  }

  // The owner of a vertex that is picked by all three.
  [[nodiscard]] int meeting_rank(const Triangle& key) const {
    return out_.vertices.owner(key.v[(key.v[0] ^ key.v[1] ^ key.v[2]) % 3]);
  }

  // By vertex of a piece that is asked about: 1 if other ranks use it, too; 0 for the others.
  [[nodiscard]] std::vector<std::uint8_t> used_by_others(std::span<const std::uint32_t> vertices,
                                                         std::span<const std::uint8_t> asked) {
    std::vector<std::uint32_t> some;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (asked[i]) some.push_back(vertices[i]);
    const std::vector<std::uint8_t> answers =
        Question(ranks_, out_.vertices, some).answer<std::uint8_t>([&](std::uint32_t v, int asker) {
          return std::uint8_t{users_[v].others_than(asker)};
        });
    std::vector<std::uint8_t> out(vertices.size(), 0);
    std::size_t next = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (asked[i]) out[i] = answers[next++];
    return out;
  }

  // Vertices that have become another one, which is left or unused, get its number; unused ones get any.
  void number_moved() {
    for_pieces(ranks_, own_vertices_, [&](std::uint64_t begin, std::uint64_t end) {
      std::vector<std::uint32_t> become;
      const auto for_moved = [&](const auto& visit) {
        for (std::uint64_t i = begin; i < end; ++i)
          if (!out_.left[i] && out_.numbers[i] != first_vertex_ + i) visit(i);
      };
      for_moved([&](std::uint64_t i) { become.push_back(out_.numbers[i]); });
      const std::vector<std::uint32_t> numbers =
          Question(ranks_, out_.vertices, become).answer<std::uint32_t>([&](std::uint32_t v) {
            return out_.numbers[v];
          });
      std::size_t next = 0;
      for_moved([&](std::uint64_t i) { out_.numbers[i] = numbers[next++]; });
    });
  }

  // Calls visit(at, positions) for the vertices of the slice, from `at` on.
  template <class Visit>
  void visit_vertices(const Visit& visit) {
    constexpr std::uint64_t grain = 1 << 16;
    std::vector<Vec3d> positions;
    for (std::uint64_t at = 0; at < own_vertices_; at += grain) {
      positions.resize(std::min(grain, own_vertices_ - at));
      stream_.read_vertices(first_vertex_ + at, positions);
      visit(at, std::span<const Vec3d>(positions));
    }
  }
  // The same for the triangles, as they are in the input, in rounds of all ranks.
  template <class Visit>
  void visit_triangles(const Visit& visit) {
    std::vector<Triangle> triangles;
    for_pieces(ranks_, own_triangles_, [&](std::uint64_t begin, std::uint64_t end) {
      triangles.resize(end - begin);
      stream_.read_triangles(first_triangle_ + begin, triangles);
      visit(begin, std::span<const Triangle>(triangles));
    });
  }
  // Calls visit(at, corners, become, count): `become` has what the corners' vertices have become by welding.
  template <class Visit>
  void visit_welded(const Visit& visit) {
    visit_triangles([&](std::uint64_t at, std::span<const Triangle> triangles) {
      const PieceCorners corners(triangles);
      std::vector<std::uint32_t> become(corners.vertices().begin(), corners.vertices().end());
      if (out_.repairs.welded_vertices > 0)
        become = Question(ranks_, out_.vertices, become).answer<std::uint32_t>([&](std::uint32_t v) {
          return out_.numbers[v];
        });
      visit(at, corners, become, triangles.size());
    });
  }

  // Marks those of the vertices of a piece that are used, at their owners.
  void mark_used(std::span<const std::uint32_t> vertices, std::span<const std::uint8_t> used) {
    std::vector<std::uint32_t> some;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (used[i]) some.push_back(vertices[i]);
    const Question question(ranks_, out_.vertices, some);
    for (std::size_t rank = 0; rank < question.asked().size(); ++rank)
      for (const std::uint32_t v : question.asked()[rank]) {
        states_[v] = VertexState::used;
        if (!users_.empty()) users_[v].add(static_cast<int>(rank));
      }
  }

  const MeshStream& stream_;
  std::uint64_t most_items_;
  Ranks& ranks_;
  Scheduler& scheduler_;
  CleanSlices out_;  // numbers: first what each vertex has become by welding; empty if none has
  std::uint64_t first_vertex_ = 0, first_triangle_ = 0, own_vertices_ = 0, own_triangles_ = 0;
  std::vector<VertexState> states_;  // by vertex of the slice
  std::vector<Users> users_;         // of those that are marked as used
};

}  // namespace

PieceCorners::PieceCorners(std::span<const Triangle> triangles) : local_(triangles.size()) {
  numbers_.clear(triangles.size() / 2 + triangles.size() / 8);
  if (!triangles.empty()) numbers_.number({triangles.data()->v.data(), 3 * triangles.size()}, local_.data()->v.data());
}

CleanSlices distributed_clean(const RankInput& input, Lattice lattice, Ranks& ranks, Scheduler& scheduler,
                              std::uint64_t most_items) {
  DistributedCleaning cleaning(input, most_items, ranks, scheduler);
  ranks.begin("reading corners");
  cleaning.drop_non_finite_triangles();
  cleaning.normalise(lattice);
  ranks.begin("welding");
  cleaning.weld_vertices();
  cleaning.drop_degenerate_triangles();
  ranks.begin("comparing triangles");
  cleaning.drop_duplicate_triangles();
  cleaning.number_vertices();
  return std::move(cleaning).result();
}

}  // namespace lodestone
