#include "experiments/metrics/drawn/border.h"

#include <algorithm>
#include <tuple>

namespace lodestone {
namespace {

// One number for all vertices at one place, in the order of places; -0 and +0 are one place.
std::vector<std::uint32_t> weld(std::span<const Vec3d> positions) {
  std::vector<std::uint32_t> order(positions.size()), ids(positions.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto key = [&](std::uint32_t i) { return std::tuple(positions[i].x, positions[i].y, positions[i].z); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::uint32_t id = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && key(order[i - 1]) != key(order[i])) ++id;
    ids[order[i]] = id;
  }
  return ids;
}

}  // namespace

// Edges of one lower end lie side by side; they are few.
std::vector<BorderEdge> border_edges(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  const std::vector<std::uint32_t> ids = weld(positions);
  struct Half {
    BorderEdge edge;
    int sign = 1;
  };
  const auto for_halves = [&](const auto& use) {
    for (const Triangle& t : triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t.v[k], b = t.v[(k + 1) % 3];
        if (ids[a] < ids[b]) use(Half{{{ids[a], ids[b]}, {a, b}}, 1});
        if (ids[b] < ids[a]) use(Half{{{ids[b], ids[a]}, {b, a}}, -1});
      }
  };
  std::vector<std::size_t> first(ids.size() + 2, 0);  // by lower end; after placing, where the next one begins
  for_halves([&](const Half& half) { ++first[half.edge.end[0] + 2]; });
  for (std::size_t i = 2; i < first.size(); ++i) first[i] += first[i - 1];
  std::vector<Half> halves(first.back());
  for_halves([&](const Half& half) { halves[first[half.edge.end[0] + 1]++] = half; });

  std::vector<BorderEdge> border;
  for (std::size_t lower = 0; lower < ids.size(); ++lower) {
    const std::span<Half> around(halves.data() + first[lower], halves.data() + first[lower + 1]);
    std::ranges::sort(around, {}, [](const Half& half) { return half.edge.end[1]; });
    for (std::size_t begin = 0, end = 0; begin < around.size(); begin = end) {
      int net = 0;
      while (end < around.size() && around[end].edge.end == around[begin].edge.end) net += around[end++].sign;
      if (net != 0) border.push_back(around[begin].edge);
    }
  }
  return border;
}

}  // namespace lodestone
