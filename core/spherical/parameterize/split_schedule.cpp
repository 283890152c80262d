#include "core/spherical/parameterize/split_schedule.h"

#include <algorithm>
#include <cmath>

namespace lodestone::spherical {
namespace {

// The numbers of splits at the ends of the levels: counted down from the last, so that it is not a small one.
std::vector<std::size_t> level_ends(std::size_t splits, double growth) {
  constexpr std::size_t base = 4, few = 100;
  std::vector<std::size_t> ends;
  for (std::size_t vertices = base + splits; vertices > base;) {
    ends.push_back(vertices - base);
    const double factor = vertices > few ? growth : std::sqrt(growth);
    vertices = std::min(vertices - 1, static_cast<std::size_t>(static_cast<double>(vertices) / factor));
  }
  std::reverse(ends.begin(), ends.end());
  return ends;
}

}  // namespace

SplitSchedule make_split_schedule(const progressive::RingMesh& rings, std::span<const VertexSplit> collapses,
                                  double growth) {
  const std::size_t count = collapses.size();
  SplitSchedule out;
  out.splits.reserve(count);
  std::vector<std::uint32_t> touched(rings.vertex_count(), 0);  // the number of the first wave that may touch it
  std::vector<std::uint32_t> wave_of;
  std::vector<std::size_t> first;
  std::size_t begin = 0;
  for (const std::size_t end : level_ends(count, growth)) {
    const auto base = static_cast<std::uint32_t>(out.waves.size());
    out.levels.push_back(base);
    wave_of.clear();
    std::uint32_t last = base;
    for (std::size_t k = begin; k < end; ++k) {
      const VertexSplit& split = collapses[count - 1 - k];
      const std::span ring(rings.ring(split.vertex).ids, split.ring);
      std::uint32_t wave = base;
      for (const Id x : ring) wave = std::max(wave, touched[x]);
      for (const Id x : ring) touched[x] = wave + 1;
      touched[split.vertex] = wave + 1;
      wave_of.push_back(wave - base);
      last = std::max(last, wave);
    }
    first.assign(last - base + 2, 0);
    for (const std::uint32_t wave : wave_of) ++first[wave + 1];
    for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
    for (std::size_t k = 0; k + 1 < first.size(); ++k) out.waves.push_back(begin + first[k]);
    out.splits.resize(end);
    for (std::size_t k = begin; k < end; ++k)
      out.splits[begin + first[wave_of[k - begin]]++] = collapses[count - 1 - k];
    begin = end;
  }
  out.levels.push_back(out.waves.size());
  out.waves.push_back(count);
  return out;
}

}  // namespace lodestone::spherical
