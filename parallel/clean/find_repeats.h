// Equal items found by their hashes, bucket by bucket, in parallel.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/mesh/clean_kernels.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Items sorted into buckets by a stable counting sort on the top bits of their hashes: within a bucket they are in
// ascending order of their number, for any number of workers. Memory: 8 bytes per item.
class HashPartition {
 public:
  static constexpr std::size_t grain = std::size_t{1} << 16;  // of the ranges that are visited

  // visit(range, take) calls take(i, hash) for the items of the range that take part, in ascending order. It is called
  // twice for each range.
  template <class Visit>
  HashPartition(std::size_t count, const Visit& visit, Scheduler& scheduler);

  [[nodiscard]] std::size_t buckets() const { return begin_.size() - 1; }
  [[nodiscard]] std::span<const HashedItem> bucket(std::size_t k) const {
    return {items_.get() + begin_[k], begin_[k + 1] - begin_[k]};
  }

 private:
  std::unique_ptr<HashedItem[]> items_;
  std::vector<std::size_t> begin_;  // of each bucket, and the end of the last
};

template <class Visit>
HashPartition::HashPartition(std::size_t count, const Visit& visit, Scheduler& scheduler) {
  // Buckets whose table fits into the second-level cache, but not so many that scattering into them misses the TLB.
  constexpr std::size_t items_per_bucket = 16384, max_bucket_bits = 10;
  unsigned bits = 0;
  while (bits < max_bucket_bits && (items_per_bucket << bits) < count) ++bits;
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

inline constexpr std::size_t all_in_memory = std::size_t{1} << 60;  // working bytes: one round

// Calls found(repeat, first) for every item that equals(repeat, first) an earlier one, at once for different buckets.
// Returns how many there are. `visit` is as in HashPartition. It takes as many rounds as it needs to hold the items in
// working_bytes, and calls `visit` twice in each.
template <class Visit, class Equals, class Found>
std::uint64_t find_repeats(std::size_t count, std::size_t working_bytes, const Visit& visit, const Equals& equals,
                           const Found& found, Scheduler& scheduler) {
  const std::uint64_t rounds =
      std::clamp<std::uint64_t>((count * sizeof(HashedItem) * 9 / 8 + working_bytes) / (working_bytes + 1), 1, 1 << 12);
  std::vector<RepeatFinder> finders(static_cast<std::size_t>(scheduler.workers()));
  std::uint64_t total = 0;
  for (std::uint64_t round = 0; round < rounds; ++round) {
    const auto visit_round = [&](ChunkRange range, const auto& take) {
      visit(range, [&](std::size_t i, std::uint64_t hash) {
        // By bits that HashPartition does not look at.
        if (((hash >> 36 & 0xffff) * rounds) >> 16 == round) take(i, hash);
      });
    };
    const HashPartition partition(count, visit_round, scheduler);
    std::vector<std::uint64_t> repeats(partition.buckets(), 0);
    scheduler.for_chunks(partition.buckets(), 1, [&](ChunkRange range) {
      finders[static_cast<std::size_t>(scheduler.worker_index())].find(partition.bucket(range.begin), equals,
                                                                       [&](std::uint32_t repeat, std::uint32_t first) {
                                                                         found(repeat, first);
                                                                         ++repeats[range.index];
                                                                       });
    });
    for (const std::uint64_t here : repeats) total += here;
  }
  return total;
}

// The numbers of an item, and of the one with the smallest number that equals it.
template <class Number>
struct Repeat {
  Number repeat, first;
};

// The repeats among items {key, number} in any order of their numbers, which change places among equal items. Keys have
// hash_of and ==.
template <class Item>
[[nodiscard]] auto repeats_among(std::vector<Item>& items, Scheduler& scheduler) {
  constexpr std::uint32_t none = 0xffff'ffffu;
  std::vector<std::uint32_t> first_of(items.size(), none);  // by item that equals another one: that
  find_repeats(
      items.size(), all_in_memory,
      [&](ChunkRange range, const auto& take) {
        for (std::size_t i = range.begin; i < range.end; ++i) take(i, hash_of(items[i].key));
      },
      [&](std::uint32_t a, std::uint32_t b) { return items[a].key == items[b].key; },
      [&](std::uint32_t repeat, std::uint32_t first) {  // all that are equal: on one thread
        if (items[repeat].number < items[first].number) std::swap(items[repeat].number, items[first].number);
        first_of[repeat] = first;
      },
      scheduler);
  std::vector<Repeat<decltype(Item::number)>> repeats;
  for (std::size_t i = 0; i < items.size(); ++i)
    if (first_of[i] != none) repeats.push_back({items[i].number, items[first_of[i]].number});
  return repeats;
}

}  // namespace lodestone
