// Consecutive numbers dealt out to the ranks, and questions about what belongs to a number, to the rank that has it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "parallel/distributed/pieces.h"

namespace lodestone {

class Slices {
 public:
  Slices() = default;  // none
  // Slices of these sizes, by rank.
  explicit Slices(std::span<const std::uint64_t> sizes) {
    for (const std::uint64_t size : sizes) first_.push_back(first_.back() + size);
  }
  // Slices that differ by one at most.
  Slices(std::uint64_t total, int ranks) {
    const auto count = static_cast<std::uint64_t>(ranks);
    for (std::uint64_t r = 1; r <= count; ++r) first_.push_back(total / count * r + std::min(r, total % count));
  }
  [[nodiscard]] std::uint64_t begin(int rank) const { return first_[static_cast<std::size_t>(rank)]; }
  [[nodiscard]] std::uint64_t end(int rank) const { return first_[static_cast<std::size_t>(rank) + 1]; }
  [[nodiscard]] std::uint64_t size(int rank) const { return end(rank) - begin(rank); }
  [[nodiscard]] std::uint64_t total() const { return first_.back(); }
  [[nodiscard]] int owner(std::uint64_t number) const {
    return static_cast<int>(std::ranges::upper_bound(first_, number) - first_.begin()) - 1;
  }

 private:
  std::vector<std::uint64_t> first_{0};  // by rank, and the end
};

// Some numbers of a piece, each with its owner. All ranks ask, and answer, at the same time.
class Question {
 public:
  // Asks the owners about these numbers.
  Question(Ranks& ranks, const Slices& slices, std::span<const std::uint32_t> numbers) : ranks_(ranks) {
    ByRank<std::uint32_t> out = by_rank<std::uint32_t>(ranks);
    place_.reserve(numbers.size());
    for (const std::uint32_t number : numbers) {
      const int owner = slices.owner(number);
      std::vector<std::uint32_t>& to = out[static_cast<std::size_t>(owner)];
      place_.push_back({owner, static_cast<std::uint32_t>(to.size())});
      to.push_back(static_cast<std::uint32_t>(number - slices.begin(owner)));
    }
    asked_ = ranks.exchange(std::move(out));
  }

  // By rank: the numbers that it asks this rank about, counted from the beginning of the slice.
  [[nodiscard]] const ByRank<std::uint32_t>& asked() const { return asked_; }

  // Gives value(number) for those, and returns the values of the own numbers, in their order.
  template <class Value, class Of>
  [[nodiscard]] std::vector<Value> answer(const Of& value) const {
    ByRank<Value> out = by_rank<Value>(ranks_);
    for (std::size_t r = 0; r < out.size(); ++r) {
      out[r].reserve(asked_[r].size());
      for (const std::uint32_t number : asked_[r]) out[r].push_back(value(number));
    }
    const ByRank<Value> in = ranks_.exchange(std::move(out));
    std::vector<Value> values;
    values.reserve(place_.size());
    for (const Place& place : place_) values.push_back(in[static_cast<std::size_t>(place.owner)].at(place.index));
    return values;
  }

 private:
  struct Place {
    int owner;
    std::uint32_t index;
  };
  Ranks& ranks_;
  std::vector<Place> place_;  // by number asked about
  ByRank<std::uint32_t> asked_;
};

}  // namespace lodestone
