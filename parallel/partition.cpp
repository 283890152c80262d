// Three passes over the triangles: which cell (with a count per chunk), scatter to cell order, what the cells share.
//
// A counting sort per chunk keeps the input order within a cell for any number of workers. What several workers add
// to one place is added with operations that commute exactly: minima, maxima, and sums in fixed point.
#include "parallel/partition.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "core/hierarchy/fingerprint.h"

namespace lodestone {
namespace {

constexpr std::size_t triangle_grain = 1 << 18;
constexpr std::size_t vertex_grain = 1 << 18;
constexpr std::uint32_t unowned = 0x7fff'ffffu;

// Open-addressing map from cell code to a small number; one per chunk, so it stays in cache.
class CodeTable {
 public:
  // Number of a code, in order of first appearance.
  std::uint32_t number(CellCode code) {
    if (code == last_code_) return last_number_;
    if (2 * codes.size() >= slots_.size()) grow();
    std::uint32_t& slot = find(code);
    if (slot == none_) {
      slot = static_cast<std::uint32_t>(codes.size());
      codes.push_back(code);
    }
    last_code_ = code;
    return last_number_ = slot;
  }
  std::vector<CellCode> codes;

 private:
  static constexpr std::uint32_t none_ = 0xffff'ffffu;

  std::uint32_t& find(CellCode code) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = (code.morton * 0x9e37'79b9'7f4a'7c15ull) >> (64 - std::countr_zero(slots_.size()));
    while (slots_[i] != none_ && codes[slots_[i]] != code) i = (i + 1) & mask;
    return slots_[i];
  }
  void grow() {
    slots_.assign(std::max<std::size_t>(64, slots_.size() * 2), none_);
    for (std::uint32_t i = 0; i < codes.size(); ++i) find(codes[i]) = i;
  }

  std::vector<std::uint32_t> slots_;
  CellCode last_code_{~0ull};
  std::uint32_t last_number_ = 0;
};

struct Chunk {
  CodeTable cells;
  std::vector<std::uint64_t> count;  // by number; after `place_chunks` the position of the next triangle
  std::vector<std::uint32_t> rank;   // by number
  std::uint64_t fingerprint = 0;
};

// Sums of vectors whose result does not depend on the order: 64-bit fixed point. Twice a triangle's area is at most 2,
// and 2^54 leaves room for hundreds of such triangles while resolving areas of 1e-16.
class NormalSums {
 public:
  explicit NormalSums(std::size_t count) : sums_(count) {}
  void add(std::size_t i, Vec3f n) {
    const std::array<float, 3> v{n.x, n.y, n.z};
    for (std::size_t k = 0; k < 3; ++k)
      std::atomic_ref(sums_[i][k]).fetch_add(static_cast<std::int64_t>(v[k] * scale_), std::memory_order_relaxed);
  }
  [[nodiscard]] Vec3f sum(std::size_t i) const {
    const auto v = [&](std::size_t k) { return static_cast<float>(static_cast<double>(sums_[i][k])); };
    return {v(0), v(1), v(2)};  // the scale does not matter for a direction
  }

 private:
  static constexpr float scale_ = 0x1p54f;
  std::vector<std::array<std::int64_t, 3>> sums_;
};

// UsageBox extended by several workers: lo and hi of an axis in one word each.
class UsageBoxes {
 public:
  explicit UsageBoxes(std::size_t count) : axes_(count, {empty_, empty_, empty_}) {}
  void extend(std::size_t i, CellCoord c) {
    extend_axis(axes_[i][0], c.x);
    extend_axis(axes_[i][1], c.y);
    extend_axis(axes_[i][2], c.z);
  }
  [[nodiscard]] UsageBox box(std::size_t i) const {
    const auto lo = [&](std::size_t k) { return static_cast<std::uint16_t>(axes_[i][k] & 0xffff); };
    const auto hi = [&](std::size_t k) { return static_cast<std::uint16_t>(axes_[i][k] >> 16); };
    return {{lo(0), lo(1), lo(2)}, {hi(0), hi(1), hi(2)}};
  }

 private:
  static void extend_axis(std::uint32_t& word, std::uint32_t v) {
    const std::atomic_ref axis(word);
    std::uint32_t old = axis.load(std::memory_order_relaxed);
    for (;;) {
      const std::uint32_t extended = std::min(old & 0xffff, v) | (std::max(old >> 16, v) << 16);
      if (extended == old || axis.compare_exchange_weak(old, extended, std::memory_order_relaxed)) return;
    }
  }
  static constexpr std::uint32_t empty_ = 0x0000'ffffu;
  std::vector<std::array<std::uint32_t, 3>> axes_;
};

// Pass 1: the cell of every triangle as a number within its chunk, counted.
std::vector<Chunk> count_cells(const IndexedMesh& mesh, int level, std::vector<std::uint32_t>& number,
                               Scheduler& scheduler) {
  std::vector<Chunk> chunks(chunk_count(mesh.triangles.size(), triangle_grain));
  scheduler.for_chunks(mesh.triangles.size(), triangle_grain, [&](ChunkRange range) {
    Chunk& chunk = chunks[range.index];
    for (std::size_t t = range.begin; t < range.end; ++t) {
      const auto& v = mesh.triangles[t].v;
      const Vec3f a = mesh.positions[v[0]], b = mesh.positions[v[1]], c = mesh.positions[v[2]];
      number[t] = chunk.cells.number(CellCode::from(cell_of(barycentre(a, b, c), level)));
      if (number[t] == chunk.count.size()) chunk.count.push_back(0);
      ++chunk.count[number[t]];
      chunk.fingerprint += triangle_fingerprint(a, b, c);
    }
  });
  return chunks;
}

// The sorted union of the chunks' cells, and where each chunk's share of each cell begins.
void place_chunks(std::vector<Chunk>& chunks, Partition& out) {
  for (const Chunk& chunk : chunks) {
    out.codes.insert(out.codes.end(), chunk.cells.codes.begin(), chunk.cells.codes.end());
    out.fingerprint += chunk.fingerprint;
  }
  std::sort(out.codes.begin(), out.codes.end());
  out.codes.erase(std::unique(out.codes.begin(), out.codes.end()), out.codes.end());

  out.first_triangle.assign(out.codes.size() + 1, 0);
  for (Chunk& chunk : chunks) {
    chunk.rank.resize(chunk.count.size());
    for (std::size_t i = 0; i < chunk.count.size(); ++i) {
      const auto at = std::lower_bound(out.codes.begin(), out.codes.end(), chunk.cells.codes[i]);
      chunk.rank[i] = static_cast<std::uint32_t>(at - out.codes.begin());
      out.first_triangle[chunk.rank[i] + 1] += chunk.count[i];
    }
  }
  for (std::size_t c = 0; c < out.codes.size(); ++c) out.first_triangle[c + 1] += out.first_triangle[c];
  std::vector<std::uint64_t> next(out.first_triangle.begin(), out.first_triangle.end() - 1);
  for (Chunk& chunk : chunks)
    for (std::size_t i = 0; i < chunk.count.size(); ++i) {
      const std::uint64_t share = chunk.count[i];
      chunk.count[i] = next[chunk.rank[i]];
      next[chunk.rank[i]] += share;
    }
}

// Remembers the first cell that claims a vertex, flags the vertex when another one does. The flag does not depend on
// who came first; the owner is forgotten afterwards.
void claim_vertex(std::uint32_t& owner, std::uint32_t rank) {
  const std::atomic_ref word(owner);
  std::uint32_t old = word.load(std::memory_order_relaxed);
  while (old != rank && !(old & FinestVertices::shared_flag)) {
    const std::uint32_t claimed = old == unowned ? rank : FinestVertices::shared_flag;
    if (word.compare_exchange_weak(old, claimed, std::memory_order_relaxed)) return;
  }
}

// Pass 2: triangles to cell order; vertices claimed.
void scatter(std::vector<Chunk>& chunks, const std::vector<Triangle>& triangles,
             const std::vector<std::uint32_t>& number, Partition& out, Scheduler& scheduler) {
  scheduler.for_chunks(triangles.size(), triangle_grain, [&](ChunkRange range) {
    Chunk& chunk = chunks[range.index];
    for (std::size_t t = range.begin; t < range.end; ++t) {
      out.triangles[chunk.count[number[t]]++] = triangles[t];
      for (const std::uint32_t v : triangles[t].v) claim_vertex(out.sharing[v], chunk.rank[number[t]]);
    }
  });
}

// Replaces the owners of shared vertices by consecutive indices in vertex order; returns their number.
std::size_t number_shared(Partition& out, Scheduler& scheduler) {
  std::vector<std::size_t> first(chunk_count(out.sharing.size(), vertex_grain) + 1, 0);
  scheduler.for_chunks(out.sharing.size(), vertex_grain, [&](ChunkRange range) {
    for (std::size_t v = range.begin; v < range.end; ++v) first[range.index + 1] += out.sharing[v] >> 31;
  });
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
  scheduler.for_chunks(out.sharing.size(), vertex_grain, [&](ChunkRange range) {
    auto next = static_cast<std::uint32_t>(first[range.index]);
    for (std::size_t v = range.begin; v < range.end; ++v)
      if (out.sharing[v] & FinestVertices::shared_flag) out.sharing[v] = FinestVertices::shared_flag | next++;
  });
  return first.back();
}

// Pass 3: boxes and normals of the shared vertices.
void describe_shared(Partition& out, std::size_t shared, Scheduler& scheduler) {
  UsageBoxes boxes(shared);
  NormalSums normals(shared);
  scheduler.for_chunks(out.codes.size(), 16, [&](ChunkRange range) {
    for (std::size_t c = range.begin; c < range.end; ++c) {
      const CellCoord coord = out.codes[c].coord();
      for (std::uint64_t t = out.first_triangle[c]; t < out.first_triangle[c + 1]; ++t) {
        const auto& v = out.triangles[t].v;
        const std::array<std::uint32_t, 3> s{out.sharing[v[0]], out.sharing[v[1]], out.sharing[v[2]]};
        if (!((s[0] | s[1] | s[2]) & FinestVertices::shared_flag)) continue;
        const Vec3f a = out.positions[v[0]];
        const Vec3f n = cross(out.positions[v[1]] - a, out.positions[v[2]] - a);
        for (const std::uint32_t word : s) {
          if (!(word & FinestVertices::shared_flag)) continue;
          boxes.extend(word & ~FinestVertices::shared_flag, coord);
          normals.add(word & ~FinestVertices::shared_flag, n);
        }
      }
    }
  });
  out.shared_usage.resize(shared);
  out.shared_normals.resize(shared);
  scheduler.for_chunks(shared, vertex_grain, [&](ChunkRange range) {
    for (std::size_t i = range.begin; i < range.end; ++i) {
      out.shared_usage[i] = boxes.box(i);
      out.shared_normals[i] = normals.sum(i);
    }
  });
}

}  // namespace

Partition partition_mesh(IndexedMesh&& mesh, int level, Scheduler& scheduler) {
  Partition out;
  {
    std::vector<std::uint32_t> number(mesh.triangles.size());
    std::vector<Chunk> chunks = count_cells(mesh, level, number, scheduler);
    place_chunks(chunks, out);
    out.triangles.resize(mesh.triangles.size());
    out.sharing.assign(mesh.positions.size(), unowned);
    scatter(chunks, mesh.triangles, number, out, scheduler);
  }
  std::vector<Triangle>().swap(mesh.triangles);  // an assigned `{}` would keep the capacity
  out.positions = std::move(mesh.positions);
  describe_shared(out, number_shared(out, scheduler), scheduler);
  return out;
}

int choose_finest_level(const IndexedMesh& mesh, std::uint32_t cell_triangles) {
  constexpr std::size_t sample_size = 1 << 16;
  const std::size_t stride = std::max<std::size_t>(1, mesh.triangles.size() / sample_size);
  std::vector<Vec3f> sample;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += stride) {
    const auto& v = mesh.triangles[t].v;
    sample.push_back(barycentre(mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]));
  }
  int best = 0;
  double best_misfit = std::numeric_limits<double>::infinity();
  for (int level = 0; level <= max_level; ++level) {
    CodeTable occupied;
    for (const Vec3f p : sample) (void)occupied.number(CellCode::from(cell_of(p, level)));
    const double mean = static_cast<double>(mesh.triangles.size()) / static_cast<double>(occupied.codes.size());
    const double misfit = std::abs(std::log(mean / cell_triangles));
    if (misfit < best_misfit) best = level, best_misfit = misfit;
    if (mean < cell_triangles) break;
  }
  return best;
}

}  // namespace lodestone
