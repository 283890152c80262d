// Work on many items in rounds, so that what is under way between the ranks is bounded: about 16 MiB at a rank, and
// 64 KiB for each of them where these are more than 256.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "parallel/distributed/messages/ranks.h"

namespace lodestone {

// Items that a rank looks at in one round. Were all of them for one rank, it would get max(2^18, 2^10 R).
[[nodiscard]] inline std::uint64_t piece_items(const Ranks& ranks) {
  return std::max<std::uint64_t>((std::uint64_t{1} << 18) / static_cast<std::uint64_t>(ranks.count()), 1 << 10);
}

// Calls body(begin, end) for pieces of the own `count` items: equally often on all ranks, so that the body may make
// calls that all of them make; where a rank has no items left, for an empty piece. Each round is told as a share of the
// work at hand, for which this is taken to be all that takes time.
template <class Body>
void for_pieces(Ranks& ranks, std::uint64_t count, const Body& body) {
  const std::uint64_t piece = piece_items(ranks);
  const std::uint64_t rounds = ranks.maximum((count + piece - 1) / piece);
  for (std::uint64_t round = 0; round < rounds; ++round) {
    body(std::min(count, round * piece), std::min(count, (round + 1) * piece));
    ranks.done(static_cast<double>(round + 1) / static_cast<double>(rounds));
  }
}

// The rank at which all meet that has this hash.
[[nodiscard]] inline int rank_of_hash(std::uint64_t hash, const Ranks& ranks) {
  return static_cast<int>((hash >> 32) * static_cast<std::uint64_t>(ranks.count()) >> 32);
}

// The turn, of so many that all ranks take together, in which what has this hash is looked at: by bits on which neither
// its rank nor its bucket depends.
inline constexpr std::uint64_t most_turns = 1 << 12;
[[nodiscard]] inline std::uint64_t turn_of_hash(std::uint64_t hash, std::uint64_t turns) {
  return ((hash >> 36 & (most_turns - 1)) * turns) / most_turns;
}

// Lists of items by the rank that they go to.
template <class Item>
using ByRank = std::vector<std::vector<Item>>;
template <class Item>
[[nodiscard]] ByRank<Item> by_rank(const Ranks& ranks) {
  return ByRank<Item>(static_cast<std::size_t>(ranks.count()));
}

// Calls make(i, emit) for the own items i below `count`, each of which may emit(to, item), and take(from, items) with
// what has come, in the order of the ranks within a round. All ranks call it.
template <class Item, class Make, class Take>
void exchange_in_pieces(Ranks& ranks, std::uint64_t count, const Make& make, const Take& take) {
  for_pieces(ranks, count, [&](std::uint64_t begin, std::uint64_t end) {
    ByRank<Item> out = by_rank<Item>(ranks);
    const auto emit = [&](int to, const Item& item) { out[static_cast<std::size_t>(to)].push_back(item); };
    for (std::uint64_t i = begin; i < end; ++i) make(i, emit);
    ByRank<Item> in = ranks.exchange(std::move(out));
    for (int from = 0; from < ranks.count(); ++from) take(from, std::move(in[static_cast<std::size_t>(from)]));
  });
}

}  // namespace lodestone
