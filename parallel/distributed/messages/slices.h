// Consecutive numbers dealt out to the ranks, and questions about what belongs to a number, to the rank that has it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "parallel/distributed/messages/pieces.h"

namespace lodestone {

class Slices {
 public:
  Slices() = default;  // none
  // Slices of these sizes, by rank.
  explicit Slices(std::span<const std::uint64_t> sizes) : ranks_(sizes.size()) { append(sizes); }
  // The same, and after them another slice for each rank.
  Slices(std::span<const std::uint64_t> sizes, std::span<const std::uint64_t> more) : Slices(sizes) { append(more); }
  // Slices that differ by one at most.
  Slices(std::uint64_t total, int ranks) : ranks_(static_cast<std::size_t>(ranks)) {
    const auto count = static_cast<std::uint64_t>(ranks);
    for (std::uint64_t r = 1; r <= count; ++r) first_.push_back(total / count * r + std::min(r, total % count));
  }
  [[nodiscard]] std::uint64_t begin(int rank) const { return first_[static_cast<std::size_t>(rank)]; }
  // Numbers of the rank.
  [[nodiscard]] std::uint64_t size(int rank) const {
    std::uint64_t size = 0;
    for (auto s = static_cast<std::size_t>(rank); s + 1 < first_.size(); s += ranks_) size += first_[s + 1] - first_[s];
    return size;
  }
  [[nodiscard]] std::uint64_t total() const { return first_.back(); }
  [[nodiscard]] int owner(std::uint64_t number) const { return static_cast<int>(slice_of(number) % ranks_); }
  struct Place {
    int owner;
    std::uint64_t before;  // so many of the owner's numbers are smaller
  };
  [[nodiscard]] Place place(std::uint64_t number) const {
    const std::size_t slice = slice_of(number), owner = slice % ranks_;
    std::uint64_t before = number - first_[slice];
    for (std::size_t s = owner; s < slice; s += ranks_) before += first_[s + 1] - first_[s];
    return {static_cast<int>(owner), before};
  }

 private:
  void append(std::span<const std::uint64_t> sizes) {
    for (const std::uint64_t size : sizes) first_.push_back(first_.back() + size);
  }
  [[nodiscard]] std::size_t slice_of(std::uint64_t number) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(first_, number) - first_.begin()) - 1;
  }

  std::size_t ranks_ = 0;
  std::vector<std::uint64_t> first_{0};  // by slice, and the end
};

// Some numbers of a piece, each with its owner. All ranks ask, and answer, at the same time.
class Question {
 public:
  // Asks the owners about these numbers.
  Question(Ranks& ranks, const Slices& slices, std::span<const std::uint32_t> numbers) : ranks_(ranks) {
    ByRank<std::uint32_t> out = by_rank<std::uint32_t>(ranks);
    place_.reserve(numbers.size());
    for (const std::uint32_t number : numbers) {
      const auto [owner, before] = slices.place(number);
      std::vector<std::uint32_t>& to = out[static_cast<std::size_t>(owner)];
      place_.push_back({owner, static_cast<std::uint32_t>(to.size())});
      to.push_back(static_cast<std::uint32_t>(before));
    }
    asked_ = ranks.exchange(std::move(out));
  }

  // By rank: the places of the numbers that it asks this rank about.
  [[nodiscard]] const ByRank<std::uint32_t>& asked() const { return asked_; }

  // Gives value(number), or value(number, asking rank), for those, and returns the values of the own numbers, in their
  // order.
  template <class Value, class Of>
  [[nodiscard]] std::vector<Value> answer(const Of& value) const {
    ByRank<Value> out = by_rank<Value>(ranks_);
    for (std::size_t r = 0; r < out.size(); ++r) {
      out[r].reserve(asked_[r].size());
      for (const std::uint32_t number : asked_[r])
        if constexpr (std::is_invocable_v<Of, std::uint32_t, int>)
          out[r].push_back(value(number, static_cast<int>(r)));
        else
          out[r].push_back(value(number));
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

// Counts the ranks that ask for each number of the own slice, each of them once for a number.
class Askers {
 public:
  explicit Askers(std::uint64_t own_numbers) : counts_(own_numbers, 0) {}
  void add(const Question& question) {
    for (const std::vector<std::uint32_t>& of_rank : question.asked())
      for (const std::uint32_t n : of_rank) counts_[n] = static_cast<std::uint8_t>(std::min(counts_[n] + 1, 2));
  }
  // When all have been added, by number of the asking rank: 1 if others ask for it, too.
  [[nodiscard]] std::vector<std::uint8_t> others(const Question& question) const {
    return question.answer<std::uint8_t>([&](std::uint32_t n) { return std::uint8_t{counts_[n] > 1}; });
  }

 private:
  std::vector<std::uint8_t> counts_;  // up to 2
};

// By number of a list without repeats: 1 if lists of other ranks have it, too.
[[nodiscard]] inline std::vector<std::uint8_t> asked_by_others(const Slices& slices,
                                                               std::span<const std::uint32_t> numbers, Ranks& ranks) {
  Askers askers(slices.size(ranks.rank()));
  std::vector<std::uint8_t> out;
  const auto ask = [&](const auto& visit) {
    for_pieces(ranks, numbers.size(), [&](std::uint64_t begin, std::uint64_t end) {
      visit(Question(ranks, slices, numbers.subspan(begin, end - begin)));
    });
  };
  ask([&](const Question& question) { askers.add(question); });
  ask([&](const Question& question) {
    const std::vector<std::uint8_t> some = askers.others(question);
    out.insert(out.end(), some.begin(), some.end());
  });
  return out;
}

}  // namespace lodestone
