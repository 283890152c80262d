// Items sorted into buckets by hash, so that equal ones can be searched for bucket by bucket, in parallel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/mesh/clean_kernels.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// A stable counting sort by the top bits of the hash: within a bucket the items are in ascending order of their number,
// for any number of workers. Memory: 8 bytes per item.
class HashPartition {
 public:
  // hash_of(i) is asked twice for each i in [0, count) that takes part, i.e. for which takes_part(i).
  template <class TakesPart, class HashOf>
  HashPartition(std::size_t count, const TakesPart& takes_part, const HashOf& hash_of, Scheduler& scheduler)
      : HashPartition(
            count,
            [&](ChunkRange range, const auto& emit) {
              for (std::size_t i = range.begin; i < range.end; ++i)
                if (takes_part(i)) emit(i, hash_of(i));
            },
            scheduler) {}

  // The same for items that are cheaper to come by in pieces: visit(range, emit) calls emit(i, hash) for the items of
  // the range that take part, in ascending order. It is called twice for each range.
  template <class Visit>
  HashPartition(std::size_t count, const Visit& visit, Scheduler& scheduler);

  static constexpr std::size_t grain = std::size_t{1} << 16;  // the ranges that items are visited in

  [[nodiscard]] std::size_t buckets() const { return begin_.size() - 1; }
  [[nodiscard]] std::span<const HashedItem> bucket(std::size_t k) const {
    return {items_.get() + begin_[k], begin_[k + 1] - begin_[k]};
  }

  // Calls found(repeat, first) for every item that equals an earlier one, at once for different buckets. Returns how
  // many there are.
  template <class Equals, class Found>
  std::uint64_t find_repeats(const Equals& equals, const Found& found, Scheduler& scheduler) const;

 private:
  std::unique_ptr<HashedItem[]> items_;
  std::vector<std::size_t> begin_;  // of each bucket, and the end of the last
};

template <class Visit>
HashPartition::HashPartition(std::size_t count, const Visit& visit, Scheduler& scheduler) {
  // Buckets whose table stays in the second-level cache, but not so many that scattering into them misses the TLB.
  constexpr std::size_t items_per_bucket = 16384, most_bucket_bits = 10;
  unsigned bits = 0;
  while (bits < most_bucket_bits && (items_per_bucket << bits) < count) ++bits;
  const std::size_t bucket_count = std::size_t{1} << bits;
  const auto bucket_of = [bits](std::uint64_t hash) {
    return bits == 0 ? 0 : static_cast<std::size_t>(hash >> (64 - bits));
  };

  // slot[chunk][bucket]: first how many, then where the next one goes.
  std::vector<std::uint32_t> counts(chunk_count(count, grain) * bucket_count, 0);
  scheduler.for_chunks(count, grain, [&](ChunkRange range) {
    std::uint32_t* const mine = counts.data() + range.index * bucket_count;
    visit(range, [&](std::size_t, std::uint64_t hash) { ++mine[bucket_of(hash)]; });
  });
  begin_.assign(bucket_count + 1, 0);
  std::uint32_t next = 0;
  for (std::size_t bucket = 0; bucket < bucket_count; ++bucket) {
    begin_[bucket] = next;
    for (std::size_t slot = bucket; slot < counts.size(); slot += bucket_count) {
      const std::uint32_t here = counts[slot];
      counts[slot] = next;
      next += here;
    }
  }
  begin_[bucket_count] = next;
  items_ = std::make_unique_for_overwrite<HashedItem[]>(next);
  scheduler.for_chunks(count, grain, [&](ChunkRange range) {
    std::uint32_t* const mine = counts.data() + range.index * bucket_count;
    visit(range, [&](std::size_t i, std::uint64_t hash) {
      items_[mine[bucket_of(hash)]++] = {static_cast<std::uint32_t>(hash), static_cast<std::uint32_t>(i)};
    });
  });
}

template <class Equals, class Found>
std::uint64_t HashPartition::find_repeats(const Equals& equals, const Found& found, Scheduler& scheduler) const {
  std::vector<RepeatFinder> finders(static_cast<std::size_t>(scheduler.workers()));
  std::vector<std::uint64_t> repeats(buckets(), 0);
  scheduler.for_chunks(buckets(), 1, [&](ChunkRange range) {
    RepeatFinder& finder = finders[static_cast<std::size_t>(scheduler.worker_index())];
    finder.find(bucket(range.begin), equals, [&](std::uint32_t repeat, std::uint32_t first) {
      found(repeat, first);
      ++repeats[range.index];
    });
  });
  std::uint64_t total = 0;
  for (const std::uint64_t count : repeats) total += count;
  return total;
}

}  // namespace lodestone
