#include "core/mesh/edge_census.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/error.h"

namespace lodestone {
namespace {

// Calls visit(smaller, larger, forward) for the three half-edges of every triangle; forward: it runs from the smaller
// id to the larger one.
template <class Visit>
void for_half_edges(std::span<const Triangle> triangles, const Visit& visit) {
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [from, to] = std::pair(t.v[k], t.v[(k + 1) % 3]);
      visit(std::min(from, to), std::max(from, to), from < to);
    }
}

// First index of the half-edges of each smaller vertex, and the end of the last.
std::vector<std::uint32_t> begins(std::span<const Triangle> triangles, std::size_t vertex_count) {
  std::vector<std::uint32_t> begin(vertex_count + 1, 0);
  for_half_edges(triangles, [&](std::uint32_t smaller, std::uint32_t, bool) { ++begin[smaller + 1]; });
  for (std::size_t v = 0; v < vertex_count; ++v) begin[v + 1] += begin[v];
  return begin;
}

void count_edge(std::size_t forward, std::size_t backward, EdgeCensus& census) {
  ++census.edges;
  census.border += forward + backward == 1;
  census.non_manifold += forward + backward > 2;
  census.inconsistent += forward + backward == 2 && forward != 1;
}

}  // namespace

void count_edges_of_vertex(std::span<std::uint64_t> keys, EdgeCensus& census) {
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 0; i < keys.size();) {
    const std::uint64_t edge = keys[i] >> 1;
    std::size_t both[2] = {0, 0};
    for (; i < keys.size() && keys[i] >> 1 == edge; ++i) ++both[keys[i] & 1];
    count_edge(both[1], both[0], census);
  }
}

EdgeCensus count_edges(std::span<const Triangle> triangles, std::size_t vertex_count) {
  if (triangles.size() > std::numeric_limits<std::uint32_t>::max() / 3)
    throw ResourceError("the model has more half-edges than 32-bit numbers can count; split it");
  std::vector<std::uint32_t> next = begins(triangles, vertex_count);
  std::vector<std::uint64_t> keys(3 * triangles.size());
  for_half_edges(triangles, [&](std::uint32_t smaller, std::uint32_t larger, bool forward) {
    keys[next[smaller]++] = half_edge_key(larger, forward);
  });
  EdgeCensus census;
  std::size_t begin = 0;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const std::size_t end = next[v];  // after placing, the begin of the next vertex
    count_edges_of_vertex(std::span(keys).subspan(begin, end - begin), census);
    begin = end;
  }
  return census;
}

}  // namespace lodestone
