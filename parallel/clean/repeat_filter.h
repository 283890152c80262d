// Which triangles may have an equal: nearly none, so that only those have to be sorted and compared.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <vector>

#include "core/base/prefetch.h"
#include "core/mesh/clean.h"
#include "parallel/scheduler/first_touch.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// A word per vertex, for the triangles whose smallest corner it is: of the 32 kinds that a hash of the other two tells
// apart, the lower bits have those that were seen, the upper those that were seen again. Which bits are set in the end
// does not depend on who set them first. Three triangles in a hundred come to share a kind by chance. Memory: 8 bytes
// per vertex, near each other for triangles near each other.
class RepeatFilter {
 public:
  RepeatFilter(const std::vector<Triangle>& triangles, std::size_t vertices, Scheduler& scheduler)
      : triangles_(triangles) {
    resize_in_parallel(words_, vertices, scheduler);
    scheduler.for_chunks(triangles.size(), grain,
                         [&](ChunkRange range) { for_each_ahead(range, [&](const Triangle& t) { add(t); }); });
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

  static std::uint64_t kind_of(const Triangle& canonical) {
    return std::uint64_t{1} << ((canonical.v[1] * 0x9e37'79b9u + canonical.v[2] * 0x85eb'ca6bu) >> 27);
  }

  void add(const Triangle& triangle) {
    if (is_degenerate(triangle)) return;
    const Triangle t = canonical(triangle);
    const std::uint64_t seen = kind_of(t);
    const std::atomic_ref word(words_[t.v[0]]);
    if ((word.fetch_or(seen, std::memory_order_relaxed) & seen) != 0)
      word.fetch_or(seen << 32, std::memory_order_relaxed);
  }
  [[nodiscard]] bool is_repeated(const Triangle& triangle) const {
    const Triangle t = canonical(triangle);
    return (words_[t.v[0]] & kind_of(t) << 32) != 0;
  }

  const std::vector<Triangle>& triangles_;
  std::vector<std::uint64_t> words_;
};

}  // namespace lodestone
