// A space of 64-bit words under exclusive or.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lodestone::spherical {

class XorBasis {
 public:
  [[nodiscard]] std::size_t size() const { return words_.size(); }
  void clear() { words_.clear(); }

  // Zero if and only if the word is in the space.
  [[nodiscard]] std::uint64_t reduce(std::uint64_t word) const {
    for (const std::uint64_t basis : words_) word = std::min(word, word ^ basis);
    return word;
  }
  // A word that is not in the space yet.
  void add(std::uint64_t word) {
    words_.push_back(reduce(word));
    std::sort(words_.begin(), words_.end(), std::greater<>());
  }

 private:
  std::vector<std::uint64_t> words_;  // falling, each with a highest bit of its own
};

}  // namespace lodestone::spherical
