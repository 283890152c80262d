#include "core/progressive/lpm/split_order.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

namespace lodestone::progressive {
namespace {

constexpr std::uint32_t least_batch = 16;

// The splits of one batch, vertices [first, end) in the old order.
class Batch {
 public:
  Batch(const SplitSequence& splits, std::uint32_t first, std::uint32_t end, std::vector<std::uint32_t>& number)
      : splits_(splits), first_(first), number_(number), waits_(end - first), allows_(end - first) {
    for (std::uint32_t v = first; v < end; ++v)
      for (const std::uint32_t x : splits.star(v - splits.base))
        if (x >= first) ++waits_[v - first], allows_[x - first].push_back(v);
    for (std::uint32_t v = first; v < end; ++v)
      if (waits_[v - first] == 0) make_ready(v);
  }

  // Returns the last parent. The next one is the nearest above the one before, or the first of all: two splits of one
  // vertex do not follow each other, if there is a choice, as their vertices might be taken for wedges of one.
  std::uint32_t place(std::uint32_t parent) {
    for (std::uint32_t next = first_; !ready_.empty(); ++next) {
      auto at = ready_.lower_bound({parent + 1, 0});
      if (at == ready_.end()) at = ready_.begin();
      const std::uint32_t v = at->second;
      parent = at->first;
      ready_.erase(at);
      number_[v] = next;
      for (const std::uint32_t w : allows_[v - first_])
        if (--waits_[w - first_] == 0) make_ready(w);
    }
    return parent;
  }

 private:
  void make_ready(std::uint32_t v) { ready_.emplace(number_[splits_.parents[v - splits_.base]], v); }

  const SplitSequence& splits_;
  std::uint32_t first_;
  std::vector<std::uint32_t>& number_;
  std::vector<std::uint32_t> waits_;                         // by split: those before it that are not placed
  std::vector<std::vector<std::uint32_t>> allows_;           // by split: those that wait for it
  std::set<std::pair<std::uint32_t, std::uint32_t>> ready_;  // new number of the parent, vertex
};

}  // namespace

std::vector<std::uint32_t> order_in_batches(const SplitSequence& splits, std::uint32_t share) {
  const auto count = static_cast<std::uint32_t>(splits.base + splits.parents.size());
  std::vector<std::uint32_t> number(count);
  std::iota(number.begin(), number.end(), 0u);
  if (share == 0) return number;
  std::uint32_t parent = 0;
  for (std::uint32_t first = splits.base, end = 0; first < count; first = end) {
    end = first + std::min(count - first, std::max(first / share, least_batch));
    parent = Batch(splits, first, end, number).place(parent);
  }
  return number;
}

}  // namespace lodestone::progressive
