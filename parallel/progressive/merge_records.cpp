// A sample sort: ranges of ranks are independent, and a range of a sorted part is one piece of it.
#include "parallel/progressive/merge_records.h"

#include <algorithm>
#include <cstddef>

namespace lodestone {
namespace {

using progressive::CollapseRecord;

bool is_before(const CollapseRecord& a, const CollapseRecord& b) { return a.order < b.order; }

// The beginnings of all ranges except for the first, by a sample of the parts.
std::vector<float> range_starts(std::span<const std::vector<CollapseRecord>> parts, std::size_t count) {
  constexpr std::size_t grain = 8192, step = 64;
  std::vector<float> sample;
  for (const auto& part : parts)
    for (std::size_t k = step / 2; k < part.size(); k += step) sample.push_back(part[k].order);
  std::sort(sample.begin(), sample.end());
  std::vector<float> starts;
  const std::size_t ranges = sample.empty() ? 1 : count / grain + 1;
  for (std::size_t r = 1; r < ranges; ++r) starts.push_back(sample[r * sample.size() / ranges]);
  return starts;
}

}  // namespace

void merge_records(std::span<const std::vector<CollapseRecord>> parts, std::vector<CollapseRecord>& records,
                   Scheduler& scheduler) {
  std::size_t count = 0;
  for (const auto& part : parts) count += part.size();
  const std::vector<float> starts = range_starts(parts, count);
  const std::size_t ranges = starts.size() + 1;
  // By part and range: where it begins in the part.
  std::vector<std::size_t> first(parts.size() * (ranges + 1)), place(ranges + 1, 0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::size_t* at = first.data() + p * (ranges + 1);
    const auto begin = parts[p].begin(), end = parts[p].end();
    for (std::size_t r = 1; r < ranges; ++r)
      at[r] = static_cast<std::size_t>(std::lower_bound(begin, end, CollapseRecord{.order = starts[r - 1]}, is_before) -
                                       begin);
    at[ranges] = parts[p].size();
    for (std::size_t r = 0; r < ranges; ++r) place[r + 1] += at[r + 1] - at[r];
  }
  place[0] = records.size();
  for (std::size_t r = 0; r < ranges; ++r) place[r + 1] += place[r];
  records.resize(place[ranges]);
  scheduler.for_chunks(ranges, 1, [&](ChunkRange c) {
    const auto begin = records.begin() + static_cast<std::ptrdiff_t>(place[c.index]);
    auto to = begin;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const std::size_t* at = first.data() + p * (ranges + 1) + c.index;
      to = std::copy(parts[p].begin() + static_cast<std::ptrdiff_t>(at[0]),
                     parts[p].begin() + static_cast<std::ptrdiff_t>(at[1]), to);
    }
    std::stable_sort(begin, to, is_before);
  });
}

}  // namespace lodestone
