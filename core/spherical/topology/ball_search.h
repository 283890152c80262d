// Shortest paths from a vertex of a surface, as far as a radius, and the shortest loop that they close without
// separating the surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/spherical/topology/near_queue.h"
#include "core/spherical/topology/surface_graph.h"
#include "core/spherical/topology/xor_basis.h"

namespace lodestone::spherical {

// A simple cycle; none if it has no vertices.
struct Loop {
  double length = std::numeric_limits<double>::infinity();
  std::uint64_t label = 0;
  std::vector<Id> vertices;
};

// Memory for searches, kept from one to the next: 20 bytes per vertex of the largest graph.
class BallSearch {
 public:
  // The shortest loop through `seed`, less what its beginning and end have in common, that is shorter than `limit` and
  // whose label is not in the space of `closed`. Ends as soon as no shorter one can follow: at half the length.
  [[nodiscard]] Loop find_loop(const SurfaceGraph& graph, const XorBasis& closed, Id seed, double limit);

  // Only the paths.
  void grow(const SurfaceGraph& graph, Id seed);

  // The vertices whose distance the last search has settled, nearest first.
  [[nodiscard]] std::span<const Id> reached() const { return reached_; }
  [[nodiscard]] float distance(Id v) const { return nodes_[v].distance; }
  [[nodiscard]] Id parent(Id v) const { return parents_[v]; }  // the seed's own is no_id
  // The simple loop that an edge between two vertices closes with their paths; it begins where these part.
  [[nodiscard]] std::vector<Id> close(Id u, Id v) const;

 private:
  struct Node {
    std::uint64_t label = 0;  // of the path
    float distance = 0;
    std::uint32_t search = 0;  // the number of the last search that saw it
  };
  void begin(const SurfaceGraph& graph, Id seed);
  bool next(const SurfaceGraph& graph, Id& v);

  std::vector<Node> nodes_;
  std::vector<Id> parents_;
  NearQueue queue_;
  std::vector<Id> reached_;
  std::uint32_t search_ = 0;
};

}  // namespace lodestone::spherical
