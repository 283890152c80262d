#include "parallel/out_of_core/stream_clean.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "core/base/error.h"
#include "core/mesh/clean.h"
#include "core/mesh/clean_kernels.h"
#include "parallel/clean/hash_partition.h"
#include "parallel/scheduler/first_touch.h"

namespace lodestone {
namespace {

constexpr std::size_t grain = std::size_t{1} << 16;  // vertices or triangles per piece; a multiple of 64

std::size_t size_of(ChunkRange range) { return range.end - range.begin; }

template <class T>
std::span<T> part(std::vector<T>& whole, ChunkRange range) {
  return std::span(whole).subspan(range.begin, size_of(range));
}

// Rounds that leave each with a part of the hashes. Bits are used that HashPartition does not look at.
struct Rounds {
  std::uint64_t count;
  Rounds(std::size_t items, std::size_t working_bytes)
      : count(std::clamp<std::uint64_t>((items * sizeof(HashedItem) * 9 / 8 + working_bytes) / (working_bytes + 1), 1,
                                        1 << 12)) {}
  [[nodiscard]] std::uint64_t of(std::uint64_t hash) const { return ((hash >> 36 & 0xffff) * count) >> 16; }
};

class Cleaning {
 public:
  Cleaning(const MeshStream& stream, std::size_t working_bytes, Scheduler& scheduler)
      : stream_(stream), working_bytes_(working_bytes), scheduler_(scheduler), states_(stream.vertex_count()) {
    out_.dropped = BitSet(stream.triangle_count());
  }

  void drop_non_finite_triangles() {
    box_ = reduce_box([&](ChunkRange range, std::span<const Vec3d> positions, Box3d& box) {
      const auto states = part(states_, range);
      classify_vertices(positions, states);
      for (std::size_t i = 0; i < positions.size(); ++i)
        if (states[i] == VertexState::unused) box = {lower(box.lo, positions[i]), upper(box.hi, positions[i])};
    });
    out_.repairs.non_finite_triangles = sum_triangles([&](ChunkRange range, std::span<Triangle> triangles) {
      const std::uint64_t dropped = drop_non_finite(triangles, states_);
      drop_degenerate(range, triangles);
      return dropped;
    });
  }

  void normalise(Lattice lattice) {
    // Vertices that no triangle uses do not count.
    if (std::ranges::find(states_, VertexState::unused) != states_.end())
      box_ = reduce_box([&](ChunkRange range, std::span<const Vec3d> positions, Box3d& box) {
        extend_box(positions, part(states_, range), box);
      });
    out_.transform = normalising_transform(box_, stream_.name());
    out_.transform.lattice =
        lattice.bits == Lattice::automatic ? choose_stream_lattice() : resolve_lattice(lattice, {}, {}, 1);
    resize_in_parallel(out_.positions, states_.size(), scheduler_);
    for_vertices([&](ChunkRange range, std::span<const Vec3d> positions) {
      normalise_vertices(out_.transform, positions, part(states_, range), part(out_.positions, range));
    });
  }

  void weld_vertices() {
    std::vector<std::uint32_t>& ids = out_.numbers;
    resize_in_parallel(ids, states_.size(), scheduler_);
    scheduler_.for_chunks(ids.size(), grain, [&](ChunkRange range) {
      std::iota(ids.begin() + static_cast<std::ptrdiff_t>(range.begin),
                ids.begin() + static_cast<std::ptrdiff_t>(range.end), static_cast<std::uint32_t>(range.begin));
    });
    const std::vector<Vec3f>& positions = out_.positions;
    const Rounds rounds(positions.size(), working_bytes_);
    for (std::uint64_t round = 0; round < rounds.count; ++round)
      out_.repairs.welded_vertices +=
          HashPartition(
              positions.size(),
              [&](ChunkRange range, const auto& emit) {
                for (std::size_t i = range.begin; i < range.end; ++i) {
                  if (states_[i] != VertexState::used) continue;
                  const std::uint64_t hash = hash_of(positions[i]);
                  if (rounds.of(hash) == round) emit(i, hash);
                }
              },
              scheduler_)
              .find_repeats([&](std::uint32_t a, std::uint32_t b) { return positions[a] == positions[b]; },
                            [&](std::uint32_t repeat, std::uint32_t first) { ids[repeat] = first; }, scheduler_);
  }

  void drop_degenerate_triangles() {
    std::uint64_t dropped = dropped_;
    if (out_.repairs.welded_vertices > 0 || dropped_ > out_.repairs.non_finite_triangles) {
      scheduler_.for_chunks(states_.size(), grain,
                            [&](ChunkRange range) { std::ranges::fill(part(states_, range), VertexState::unused); });
      dropped = sum_triangles([&](ChunkRange range, std::span<Triangle> triangles) {
        hide_dropped(range, triangles);
        const std::uint64_t degenerate = weld_triangles(out_.numbers, triangles);
        mark_used(triangles, states_);
        drop_degenerate(range, triangles);
        return degenerate;
      });
    }
    out_.repairs.degenerate_triangles = dropped - out_.repairs.non_finite_triangles;
    dropped_ = dropped;
  }

  void drop_duplicate_triangles() {
    const std::uint64_t count = stream_.triangle_count();
    const Rounds rounds(count, working_bytes_);
    const auto triangle = [&](std::uint32_t t) { return canonical(welded(t, 1).front()); };
    for (std::uint64_t round = 0; round < rounds.count; ++round)
      out_.repairs.duplicate_triangles +=
          HashPartition(
              count,
              [&](ChunkRange range, const auto& emit) {
                const std::vector<Triangle> triangles = welded(range.begin, size_of(range));
                for (std::size_t i = 0; i < triangles.size(); ++i) {
                  if (out_.dropped[range.begin + i]) continue;
                  const std::uint64_t hash = hash_of(triangles[i]);
                  if (rounds.of(hash) == round) emit(range.begin + i, hash);
                }
              },
              scheduler_)
              .find_repeats([&](std::uint32_t a, std::uint32_t b) { return triangle(a) == triangle(b); },
                            [&](std::uint32_t repeat, std::uint32_t) { out_.dropped.set_shared(repeat); }, scheduler_);
    dropped_ += out_.repairs.duplicate_triangles;
  }

  // Vertices that are left move to the front, in order.
  void squeeze_out() {
    out_.triangles = stream_.triangle_count() - dropped_;
    const std::size_t before = states_.size();
    const auto used = static_cast<std::size_t>(std::ranges::count(states_, VertexState::used));
    if (used == before) {
      std::vector<std::uint32_t>().swap(out_.numbers);
    } else {
      number_vertices_in_use();
      const std::size_t left = squeeze_vertices(states_, out_.positions);
      out_.positions.resize(left);
      if (left < before / 4) out_.positions.shrink_to_fit();  // soups; both fit where the states and numbers did
    }
    out_.repairs.unreferenced_vertices = before - out_.positions.size() - out_.repairs.welded_vertices;
  }

  void require_any_left() const {
    if (dropped_ == stream_.triangle_count()) require_survivors({}, out_.repairs, stream_.name());
  }

  [[nodiscard]] CleanStream&& result() && { return std::move(out_); }

 private:
  static Vec3d lower(Vec3d a, Vec3d b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
  static Vec3d upper(Vec3d a, Vec3d b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

  template <class Visit>
  void for_vertices(const Visit& visit) {
    scheduler_.for_chunks(stream_.vertex_count(), grain, [&](ChunkRange range) {
      std::vector<Vec3d> positions(size_of(range));
      stream_.read_vertices(range.begin, positions);
      visit(range, std::span<const Vec3d>(positions));
    });
  }

  template <class Extend>
  Box3d reduce_box(const Extend& extend_by) {
    std::vector<Box3d> boxes(chunk_count(stream_.vertex_count(), grain));
    for_vertices(
        [&](ChunkRange range, std::span<const Vec3d> positions) { extend_by(range, positions, boxes[range.index]); });
    Box3d all;
    for (const Box3d& box : boxes) all.extend(box);
    return all;
  }

  // Sums visit(range, triangles) over the pieces of the stream.
  template <class Visit>
  std::uint64_t sum_triangles(const Visit& visit) {
    std::vector<std::uint64_t> partial(chunk_count(stream_.triangle_count(), grain));
    scheduler_.for_chunks(stream_.triangle_count(), grain, [&](ChunkRange range) {
      std::vector<Triangle> triangles(size_of(range));
      stream_.read_triangles(range.begin, triangles);
      partial[range.index] = visit(range, std::span(triangles));
    });
    return std::accumulate(partial.begin(), partial.end(), std::uint64_t{0});
  }

  // Marks the degenerate ones of a piece as dropped.
  void drop_degenerate(ChunkRange range, std::span<const Triangle> triangles) {
    std::uint64_t dropped = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (!is_degenerate(triangles[i])) continue;
      out_.dropped.set(range.begin + i);
      ++dropped;
    }
    dropped_ += dropped;
  }

  void hide_dropped(ChunkRange range, std::span<Triangle> triangles) const {
    for (std::size_t i = 0; i < triangles.size(); ++i)
      if (out_.dropped[range.begin + i]) triangles[i] = {};
  }

  // Triangles by the vertices that theirs have become.
  [[nodiscard]] std::vector<Triangle> welded(std::uint64_t first, std::size_t count) const {
    std::vector<Triangle> triangles(count);
    stream_.read_triangles(first, triangles);
    if (out_.repairs.welded_vertices > 0)
      for (Triangle& t : triangles)
        for (std::uint32_t& v : t.v) v = out_.numbers[v];
    return triangles;
  }

  [[nodiscard]] Lattice choose_stream_lattice() const {
    std::vector<double> edges;
    const std::uint64_t stride = lattice_sample_stride(stream_.triangle_count());
    for (std::uint64_t t = 0; t < stream_.triangle_count(); t += stride) {
      if (out_.dropped[t]) continue;
      Triangle triangle;
      stream_.read_triangles(t, {&triangle, 1});
      std::array<Vec3d, 3> corner;
      for (std::size_t k = 0; k < 3; ++k) stream_.read_vertices(triangle.v[k], {&corner[k], 1});
      append_edges(corner[0], corner[1], corner[2], out_.transform.scale, edges);
    }
    return lattice_for(std::move(edges));
  }

  // Vertices in use first, then those that have become one of them.
  void number_vertices_in_use() {
    std::vector<std::uint32_t> first(chunk_count(states_.size(), grain));
    scheduler_.for_chunks(states_.size(), grain, [&](ChunkRange range) {
      first[range.index] = static_cast<std::uint32_t>(std::ranges::count(part(states_, range), VertexState::used));
    });
    std::uint32_t total = 0;
    for (std::uint32_t& count : first) total += std::exchange(count, total);
    std::vector<std::uint32_t>& numbers = out_.numbers;
    scheduler_.for_chunks(states_.size(), grain, [&](ChunkRange range) {
      std::uint32_t next = first[range.index];
      for (std::size_t i = range.begin; i < range.end; ++i)
        if (states_[i] == VertexState::used) numbers[i] = next++;
    });
    if (out_.repairs.welded_vertices == 0) return;
    scheduler_.for_chunks(states_.size(), grain, [&](ChunkRange range) {
      for (std::size_t i = range.begin; i < range.end; ++i)
        if (states_[i] != VertexState::used && states_[numbers[i]] == VertexState::used)
          numbers[i] = numbers[numbers[i]];
    });
  }

  const MeshStream& stream_;
  std::size_t working_bytes_;
  Scheduler& scheduler_;
  std::vector<VertexState> states_;
  Box3d box_;
  std::atomic<std::uint64_t> dropped_{0};
  CleanStream out_;
};

}  // namespace

void BitSet::set_shared(std::size_t i) {
  std::atomic_ref(words_[i / 64]).fetch_or(std::uint64_t{1} << (i % 64), std::memory_order_relaxed);
}

std::vector<Triangle> CleanStream::read(const MeshStream& stream, std::uint64_t first, std::size_t count) const {
  std::vector<Triangle> left(count);
  stream.read_triangles(first, left);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (!dropped[first + i]) left[kept++] = left[i];
  left.resize(kept);
  if (!numbers.empty())
    for (Triangle& t : left)
      for (std::uint32_t& v : t.v) v = numbers[v];
  return left;
}

CleanStream clean_stream(const MeshStream& stream, Lattice lattice, std::size_t working_bytes, Scheduler& scheduler,
                         const std::function<void(double)>& done) {
  if (stream.triangle_count() >= std::numeric_limits<std::uint32_t>::max())
    throw ResourceError(describe(stream.name(), "", "more triangles than 32-bit numbers reach", "split the model"));
  Cleaning cleaning(stream, working_bytes, scheduler);
  const auto at = [&](double share) {
    if (done) done(share);
  };
  cleaning.drop_non_finite_triangles();
  at(0.2);
  cleaning.normalise(lattice);
  at(0.3);
  cleaning.weld_vertices();
  at(0.5);
  cleaning.drop_degenerate_triangles();
  cleaning.require_any_left();
  at(0.6);
  cleaning.drop_duplicate_triangles();
  cleaning.squeeze_out();
  at(1);
  return std::move(cleaning).result();
}

}  // namespace lodestone
