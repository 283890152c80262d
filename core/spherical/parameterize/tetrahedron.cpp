#include "core/spherical/parameterize/tetrahedron.h"

#include <array>
#include <cmath>

#include "core/math/orientation.h"
#include "core/progressive/collapse/rank_heap.h"

namespace lodestone::spherical {
namespace {

using progressive::Collapse;
using progressive::Ring;
using progressive::RingMesh;

float squared_length(const RingMesh& rings, Id a, Id b) {
  const Vec3f edge = rings.position(a) - rings.position(b);
  return dot(edge, edge);
}

// Few neighbours first, but all over the surface in turn: `depth` counts collapses on top of each other. Then short
// edges.
float rank_of(const RingMesh& rings, Id v, std::uint32_t depth) {
  const Ring& ring = rings.ring(v);
  float shortest = 3;
  for (const Id x : ring.neighbours()) shortest = std::min(shortest, squared_length(rings, v, x));
  return static_cast<float>(ring.size + depth) + shortest / 4;
}

// Finds an edge that may collapse: a short one to a vertex of few neighbours. False if there is none.
bool find_collapse(const RingMesh& rings, Id v, Collapse& best) {
  best = {};
  float least = 0;
  for (const Id x : rings.ring(v).neighbours()) {
    const float cost = (squared_length(rings, v, x) + 1e-12f) * static_cast<float>(rings.ring(x).size);
    if (best.target != progressive::no_id && cost >= least) continue;
    Collapse c{.vertex = v, .target = x};
    if (rings.allows(c)) best = c, least = cost;
  }
  return best.target != progressive::no_id;
}

}  // namespace

std::vector<Id> collapse_to_tetrahedron(RingMesh& rings, std::vector<VertexSplit>& splits,
                                        progressive::RingArena& arena) {
  progressive::RankHeap queue;
  std::vector<std::uint32_t> depth(rings.vertex_count(), 0);
  std::size_t left = 0;
  for (Id v = 0; v < rings.vertex_count(); ++v) {
    if (!rings.is_used(v)) continue;
    queue.add(rank_of(rings, v, 0), v);
    ++left;
  }
  queue.order_all();
  while (left > 4 && !queue.empty()) {
    const float expected = queue.lowest();
    const Id v = queue.pop();
    if (!rings.is_used(v)) continue;
    const float rank = rank_of(rings, v, depth[v]);
    if (rank > expected) {
      queue.push(rank, v);
      continue;
    }
    Collapse c;
    if (!find_collapse(rings, v, c)) continue;  // until a neighbour is gone
    const Ring& ring = rings.ring(v);
    const std::uint32_t size = ring.size;
    rings.apply(c, arena);
    splits.push_back({v, c.target, size});
    --left;
    for (std::uint32_t k = 0; k < size; ++k) {
      const Id x = ring.ids[k];
      depth[x] = std::max(depth[x], depth[v] + 1);
      queue.push(rank_of(rings, x, depth[x]), x);
    }
  }
  std::vector<Id> vertices;
  for (Id v = 0; v < rings.vertex_count(); ++v)
    if (rings.is_used(v)) vertices.push_back(v);
  return vertices;
}

void place_tetrahedron(const RingMesh& rings, std::span<const Id> vertices, std::span<AlignedPoint4d> directions) {
  constexpr std::array<Vec3d, 4> corners{{{1, 1, 1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, -1}}};
  const double scale = 1 / std::sqrt(3.0);
  const Ring& ring = rings.ring(vertices[0]);
  directions[vertices[0]] = snapped(scale * corners[0]);
  for (std::uint32_t k = 0; k < 3; ++k) directions[ring.ids[k]] = snapped(scale * corners[k + 1]);
}

}  // namespace lodestone::spherical
