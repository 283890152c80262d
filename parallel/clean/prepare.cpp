#include "parallel/clean/prepare.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/prefetch.h"
#include "parallel/clean/cleaning.h"
#include "parallel/clean/find_repeats.h"
#include "parallel/clean/prepare_wedges.h"
#include "parallel/scheduler/first_touch.h"

namespace lodestone {
namespace {

// Finds the triangles that may have an equal: nearly none, so that only those have to be sorted and compared.
//
// A word per vertex, for the triangles whose smallest corner it is: of the 32 kinds that a hash of the other two tells
// apart, the lower bits have those that were seen, the upper those that were seen again. Which bits are set in the end
// does not depend on the order. Three triangles in a hundred share a kind by chance. Memory: 8 bytes per vertex, near
// each other for triangles near each other.
class RepeatFilter {
 public:
  RepeatFilter(const std::vector<Triangle>& triangles, std::size_t vertices, Scheduler& scheduler)
      : triangles_(triangles) {
    resize_in_parallel(words_, vertices, scheduler);
    const auto add_all = scheduler.workers() == 1 ? &RepeatFilter::add_all<true> : &RepeatFilter::add_all<false>;
    scheduler.for_chunks(triangles.size(), grain, [&](ChunkRange range) { (this->*add_all)(range); });
  }

  // The triangles, none of them degenerate, that may equal another one; ascending.
  [[nodiscard]] std::vector<std::uint32_t> candidates(Scheduler& scheduler) const {
    std::vector<std::vector<std::uint32_t>> found(chunk_count(triangles_.size(), grain));
    scheduler.for_chunks(triangles_.size(), grain, [&](ChunkRange range) {
      auto t = static_cast<std::uint32_t>(range.begin);
      for_each_ahead(range, [&](const Triangle& triangle) {
        if (!is_degenerate(triangle) && is_repeated(triangle)) found[range.index].push_back(t);
        ++t;
      });
    });
    std::vector<std::uint32_t> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

 private:
  static constexpr std::size_t grain = std::size_t{1} << 16;

  template <class Visit>
  void for_each_ahead(ChunkRange range, const Visit& visit) const {
    for (std::size_t t = range.begin; t < range.end; ++t) {
      const auto& ahead = triangles_[t + prefetch_distance < range.end ? t + prefetch_distance : t].v;
      prefetch(&words_[std::min({ahead[0], ahead[1], ahead[2]})]);
      visit(triangles_[t]);
    }
  }

  // A sum of the two products would differ by the same amount for the two triangles of every square of a regular grid:
  // at some widths most of them would be of one kind.
  static std::uint64_t kind_of(const Triangle& canonical) {
    const std::uint32_t mixed = (canonical.v[1] * 0x9e37'79b9u ^ canonical.v[2] * 0x85eb'ca6bu) * 0xc2b2'ae35u;
    return std::uint64_t{1} << (mixed >> 27);
  }

  template <bool alone>
  void add_all(ChunkRange range) {
    for_each_ahead(range, [&](const Triangle& triangle) {
      if (is_degenerate(triangle)) return;
      const Triangle t = canonical(triangle);
      add<alone>(words_[t.v[0]], kind_of(t));
    });
  }
  template <bool alone>
  static void add(std::uint64_t& word, std::uint64_t kind) {
    if constexpr (alone) {
      word |= kind | (word & kind) << 32;
    } else {
      const std::atomic_ref shared(word);
      if ((shared.fetch_or(kind, std::memory_order_relaxed) & kind) != 0)
        shared.fetch_or(kind << 32, std::memory_order_relaxed);
    }
  }
  [[nodiscard]] bool is_repeated(const Triangle& triangle) const {
    const Triangle t = canonical(triangle);
    return (words_[t.v[0]] & kind_of(t) << 32) != 0;
  }

  const std::vector<Triangle>& triangles_;
  std::vector<std::uint64_t> words_;
};

// A mesh in memory: its triangles are changed in place.
class MeshCleaning final : public Cleaning {
 public:
  MeshCleaning(RawMesh&& raw, const std::string& name, Scheduler& scheduler)
      : Cleaning(name, raw.positions.size(), raw.triangles.size(), scheduler),
        raw_(std::move(raw)),
        wedges_(raw_, scheduler),
        triangles_(std::move(raw_.triangles)) {
    repairs_.polygons_triangulated = raw_.polygons_triangulated;
    repairs_.faces_dropped = raw_.faces_dropped;
    repairs_.void_posts = raw_.void_posts;
    repairs_.filled_posts = raw_.filled_posts;
    transform_.up = raw_.up;
  }

  [[nodiscard]] IndexedMesh result(Repairs& repairs) && {
    IndexedMesh mesh{std::move(positions_), std::move(triangles_), transform_};
    wedges_.attach(mesh);
    repairs = repairs_;
    return mesh;
  }

 private:
  void read_vertices(ChunkRange range, const VisitVertices& visit) const override {
    visit(std::span(raw_.positions).subspan(range.begin, range.end - range.begin));
  }
  void update_triangles(ChunkRange range, const VisitTriangles& visit) override { visit(part(triangles_, range)); }
  [[nodiscard]] Vec3d position(std::uint32_t vertex) const override { return raw_.positions[vertex]; }
  [[nodiscard]] Triangle triangle(std::uint64_t index) const override { return triangles_[index]; }
  void release_input_positions() override { std::vector<Vec3d>().swap(raw_.positions); }

  std::uint64_t drop_duplicate_triangles() override {
    const std::vector<std::uint32_t> some =
        RepeatFilter(triangles_, positions_.size(), scheduler_).candidates(scheduler_);
    return find_repeats(
        some.size(), working_bytes_,
        [&](ChunkRange range, const auto& emit) {
          for (std::size_t i = range.begin; i < range.end; ++i) emit(i, hash_of(triangles_[some[i]]));
        },
        [&](std::uint32_t a, std::uint32_t b) {
          return canonical(triangles_[some[a]]) == canonical(triangles_[some[b]]);
        },
        [&](std::uint32_t repeat, std::uint32_t) { triangles_[some[repeat]] = {}; }, scheduler_);
  }

  void compact_triangles() override {
    if (numbers_.empty()) number_all();
    wedges_.compact(triangles_);
    compact(triangles_, grain, shrink_ratio_, scheduler_,
            [&](ChunkRange range) { return lodestone::compact_triangles(numbers_, part(triangles_, range)); });
  }

  RawMesh raw_;
  WedgePreparation wedges_;
  std::vector<Triangle> triangles_;
};

}  // namespace

IndexedMesh prepare_mesh(RawMesh&& raw, Repairs& repairs, Scheduler& scheduler, const std::string& name,
                         Lattice lattice) {
  MeshCleaning cleaning(std::move(raw), name, scheduler);
  cleaning.run(lattice);
  return std::move(cleaning).result(repairs);
}

}  // namespace lodestone
