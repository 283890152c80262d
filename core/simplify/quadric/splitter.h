// Cuts a mesh with too many vertices for 16-bit ids into parts that have few enough.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/simplify/contract/simplifier.h"

namespace lodestone::quadric {

// One part as a mesh of its own. Its vertices are numbered by first use; `vertices` are their ids in the whole.
struct Part {
  std::vector<std::uint32_t> vertices;
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> locked;   // by the caller, or because another part uses the vertex too
  std::vector<std::uint32_t> wedges;  // their ids in the whole; empty without wedges, as are the next two
  std::vector<Triangle> corners;
  std::vector<std::uint32_t> wedge_vertex;
  [[nodiscard]] SimplifyInput input(const SimplifyInput& whole, std::size_t target) const {
    SimplifyInput part{positions, triangles, locked,       whole.max_displacement,
                       target,    corners,   wedge_vertex, whole.lattice};
    part.least_share = whole.least_share;
    return part;
  }
};

// Halves the triangles until a half uses at most `max_vertices` vertices: in the order that they have, or, if that
// leaves long seams between the parts, at the median of their barycentres along the longest axis. Depends on the input
// alone. Keeps its memory between calls.
class Splitter {
 public:
  // The number of parts; at least 1 for a mesh with triangles.
  std::size_t split(const SimplifyInput& input, std::size_t max_vertices);
  // Valid until the next call.
  const Part& part(const SimplifyInput& input, std::size_t index);

 private:
  void cut(const SimplifyInput& input, std::size_t max_vertices, bool by_place);
  void halve(const SimplifyInput& input, std::size_t begin, std::size_t end, std::size_t max_vertices, bool by_place);
  void part_by_median(const SimplifyInput& input, std::size_t begin, std::size_t middle, std::size_t end);
  [[nodiscard]] std::size_t count_vertices(const SimplifyInput& input, std::size_t begin, std::size_t end);
  // The number of vertices that several parts use; marks them in shared_.
  [[nodiscard]] std::size_t find_shared(const SimplifyInput& input);
  void append_corners(const Triangle& corners, const Triangle& local);

  struct Keyed {
    std::int32_t key;
    std::uint32_t triangle;
    auto operator<=>(const Keyed&) const = default;
  };
  std::vector<Keyed> order_;                             // triangles, part after part
  std::vector<std::size_t> ends_;                        // of the parts in order_, from 0 on
  std::vector<std::uint32_t> seen_;                      // per vertex: the last count or part that used it
  std::vector<std::uint32_t> local_;                     // per vertex: its id in the part being made
  std::vector<std::uint32_t> seen_wedge_, local_wedge_;  // the same per wedge
  std::vector<std::uint8_t> shared_;                     // per vertex: used by several parts
  std::uint32_t stamp_ = 0;
  Part part_;
};

}  // namespace lodestone::quadric
