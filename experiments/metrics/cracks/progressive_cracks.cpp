#include "experiments/metrics/cracks/progressive_cracks.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "core/base/key_numbers.h"

namespace lodestone {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Chain = std::map<Edge, std::int64_t>;

struct PlaceHash {
  std::uint64_t operator()(const std::array<std::uint32_t, 3>& p) const {
    return p[0] * 0x9e3779b97f4a7c15ull ^ p[1] * 0xc2b2ae3d27d4eb4full ^ p[2] * 0x165667b19e3779f9ull;
  }
};

// Vertices of equal positions get one number. -0 is 0.
std::vector<std::uint32_t> weld(const std::vector<Vec3f>& positions) {
  KeyNumbers<std::array<std::uint32_t, 3>, PlaceHash> known;
  std::vector<std::uint32_t> out;
  for (const Vec3f p : positions) {
    const std::array<float, 3> place{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
    std::array<std::uint32_t, 3> bits{};
    std::memcpy(bits.data(), place.data(), sizeof bits);
    out.push_back(known.number(bits));
  }
  return out;
}

// Vertices that move together get the number of the first: of equal position, one after the other, and with parents
// for which that holds, too. Copies where the surface was cut apart do not.
std::vector<std::uint32_t> group(const ProgressiveMesh& mesh, const std::vector<std::uint32_t>& place) {
  std::vector<std::uint32_t> out(place.size());
  for (std::uint32_t v = 0; v < out.size(); ++v) {
    const bool near = v > 0 && v != mesh.base_vertices && place[v] == place[v - 1];
    const bool joins = near && (v < mesh.base_vertices || out[mesh.parents[v]] == out[mesh.parents[v - 1]]);
    out[v] = joins ? out[v - 1] : v;
  }
  return out;
}

void add(Chain& chain, std::uint32_t a, std::uint32_t b, std::int64_t times) {
  if (a == b) return;
  chain[std::minmax(a, b)] += a < b ? times : -times;
}

Chain boundary(const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& number) {
  Chain chain;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) add(chain, number[t.v[k]], number[t.v[(k + 1) % 3]], 1);
  return chain;
}

// The unpaired half-edges of the input, between groups. Where more than two triangles meet at an edge, all of them lie
// at one place: unpaired are those that the cut left so, as many as do not cancel there. What cancels at its place but
// not between groups is a tear, which the input does not have.
Chain open_edges(const ProgressiveMesh& mesh, const std::vector<std::uint32_t>& place) {
  Chain at_places = boundary(mesh.triangles, place), out;
  for (const auto& [edge, times] : boundary(mesh.triangles, group(mesh, place))) {
    const std::uint32_t a = place[edge.first], b = place[edge.second];
    if (a == b || times == 0) continue;
    std::int64_t& there = at_places[std::minmax(a, b)];
    const std::int64_t sign = a < b ? 1 : -1, wanted = sign * there;  // as the edge between groups runs
    if (wanted == 0 || (wanted > 0) != (times > 0)) continue;
    const std::int64_t taken = times > 0 ? std::min(times, wanted) : std::max(times, wanted);
    out[edge] += taken;
    there -= sign * taken;
  }
  return out;
}

}  // namespace

std::size_t residual_edges(const ProgressiveMesh& mesh, std::uint32_t vertices) {
  const std::vector<std::uint32_t> place = weld(mesh.positions);
  std::vector<std::uint32_t> ancestor(mesh.positions.size());
  for (std::uint32_t v = 0; v < ancestor.size(); ++v) ancestor[v] = v < vertices ? v : ancestor[mesh.parents[v]];
  Chain rest;
  for (const auto& [edge, times] : open_edges(mesh, place))
    add(rest, place[ancestor[edge.first]], place[ancestor[edge.second]], -times);
  for (const Triangle& t : mesh.triangles) {
    std::array<std::uint32_t, 3> at{};
    for (std::size_t k = 0; k < 3; ++k) at[k] = place[ancestor[t.v[k]]];
    if (at[0] == at[1] || at[1] == at[2] || at[2] == at[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) add(rest, at[k], at[(k + 1) % 3], 1);
  }
  return static_cast<std::size_t>(std::count_if(rest.begin(), rest.end(), [](const auto& e) { return e.second != 0; }));
}

std::size_t residual_edges_of_levels(const ProgressiveMesh& mesh, std::uint32_t levels) {
  std::size_t sum = 0;
  for (std::uint32_t k = 0; k < levels; ++k) {
    const std::uint64_t span = mesh.vertex_count() - mesh.base_vertices;
    auto vertices = static_cast<std::uint32_t>(mesh.base_vertices + span * k / std::max(levels - 1, 1u));
    // Wedges of one vertex come in together.
    while (vertices > mesh.base_vertices && vertices < mesh.vertex_count() &&
           mesh.positions[vertices] == mesh.positions[vertices - 1])
      --vertices;
    sum += residual_edges(mesh, vertices);
  }
  return sum;
}

}  // namespace lodestone
