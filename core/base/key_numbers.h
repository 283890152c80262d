// Consecutive numbers for keys, in the order in which they first appear.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lodestone {

// The slot at which stops(slot) holds, of a table of mask + 1 slots (a power of two) searched from `at` on. It has to
// hold at an empty slot, of which the table needs one. The processor predicts well that the first slot is the one, but
// not if it is empty: `stops` should be free of branches.
template <class Slot, class Stops>
[[nodiscard]] inline Slot& probe(Slot* slots, std::size_t mask, std::size_t at, const Stops& stops) {
  for (at &= mask; !stops(slots[at]);) at = (at + 1) & mask;
  return slots[at];
}

// Multiplication by 2^64 over the golden ratio, which leaves the upper bits well mixed.
struct FibonacciHash {
  [[nodiscard]] std::uint64_t operator()(std::uint64_t key) const { return key * 0x9e37'79b9'7f4a'7c15ull; }
};

// An open-addressing table that is at most half full, so small that the vertices of a cell fit into the first-level
// cache. At most 2^31 keys, for each of which it has two to four slots. Hash
// gives 64 bits, the upper ones well mixed.
template <class Key, class Hash = FibonacciHash>
class KeyNumbers {
 public:
  // Forgets all keys. The table is sized for as many as are expected, keeps its memory, and grows when needed.
  void clear(std::size_t expected = 0) {
    resize(std::bit_ceil(std::clamp<std::size_t>(2 * expected, 16, std::size_t{1} << 30)));
    count_ = 0;
  }

  // A new key gets the number that size() was.
  std::uint32_t number(const Key& key) {
    std::uint32_t number;
    this->number(std::span(&key, 1), &number);
    return number;
  }
  // Asks for the place of a key that will be numbered soon, for tables beyond the caches.
  void prefetch(const Key& key) const { __builtin_prefetch(slots_.data() + (Hash{}(key) >> shift_)); }
  // The numbers of several keys, which may take their place.
  void number(std::span<const Key> keys, std::uint32_t* numbers) {
    while (!keys.empty()) {
      if (room() == 0) grow();
      const std::size_t now = std::min(keys.size(), room());
      number_with_room(keys.first(now), numbers);
      keys = keys.subspan(now);
      numbers += now;
    }
  }

  [[nodiscard]] std::uint32_t size() const { return count_; }
  // The keys by number.
  [[nodiscard]] std::span<const Key> keys() const { return std::span(keys_).first(count_); }

 private:
  static constexpr std::uint32_t none = 0xffff'ffffu;
  struct Slot {
    Key key;
    std::uint32_t number;  // none: the slot is empty
  };

  // Number of new keys that leave the table at most half full.
  [[nodiscard]] std::size_t room() const { return (mask_ + 1) / 2 - count_; }

  void resize(std::size_t slots) {
    if (slots_.size() < slots) slots_.resize(slots);
    std::fill_n(slots_.begin(), slots, Slot{{}, none});
    mask_ = slots - 1;
    shift_ = 64 - std::countr_zero(slots);
    if (keys_.size() <= slots / 2) keys_.resize(slots / 2 + 1);
  }
  void grow() {
    resize(std::max<std::size_t>(16, 2 * (mask_ + 1)));
    for (std::uint32_t n = 0; n < count_; ++n)
      probe(slots_.data(), mask_, Hash{}(keys_[n]) >> shift_, [](const Slot& slot) { return slot.number == none; }) = {
          keys_[n], n};
  }

  // Every sixth vertex of a cell is new, unpredictably: hence without a branch. Members are held in registers,
  // since what is written through `numbers` might be one of them.
  void number_with_room(std::span<const Key> keys, std::uint32_t* numbers) {
    Slot* const slots = slots_.data();
    Key* const by_number = keys_.data();
    const std::size_t mask = mask_;
    const int shift = shift_;
    std::uint32_t count = count_;
    for (const Key& given : keys) {
      const Key key = given;
      Slot& slot =
          probe(slots, mask, Hash{}(key) >> shift, [&](const Slot& s) { return (s.key == key) | (s.number == none); });
      const std::uint32_t number = std::min(slot.number, count);
      slot = {key, number};
      by_number[count] = key;
      count += number == count;
      *numbers++ = number;
    }
    count_ = count;
  }

  std::vector<Slot> slots_;  // the first mask_ + 1 are in use
  std::vector<Key> keys_;    // by number, with space for one more than the table
  std::size_t mask_ = 0;
  int shift_ = 0;
  std::uint32_t count_ = 0;
};

}  // namespace lodestone
