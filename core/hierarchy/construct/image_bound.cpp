#include "core/hierarchy/construct/image_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/base/sort_unique.h"
#include "core/spatial/point_triangle.h"

namespace lodestone {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Corners = std::array<Vec3d, 3>;

Edge edge_of(const Triangle& t, std::size_t k) { return std::minmax(t.v[k], t.v[(k + 1) % 3]); }

Corners corners_of(const Triangle& t, const Cell& cell) {
  return {to_double(cell.positions[t.v[0]]), to_double(cell.positions[t.v[1]]), to_double(cell.positions[t.v[2]])};
}

std::vector<Edge> edges_of(const Cell& cell) {
  std::vector<Edge> edges;
  edges.reserve(3 * cell.triangles.size());
  for (const Triangle& t : cell.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(edge_of(t, k));
  sort_unique(edges);
  return edges;
}

// The image in `cell` of each vertex of one of its descendants.
std::vector<std::uint32_t> images_in(const Hierarchy& hierarchy, CellId cell, CellId below) {
  std::vector<std::uint32_t> images(hierarchy.cells[below].positions.size());
  std::iota(images.begin(), images.end(), 0u);
  for (; below != cell; below = hierarchy.cells[below].parent)
    for (std::uint32_t& v : images) v = hierarchy.cells[below].parents[v];
  return images;
}

Triangle image_of(const Triangle& t, const std::vector<std::uint32_t>& images) {
  return {{images[t.v[0]], images[t.v[1]], images[t.v[2]]}};
}

double longest_side(const Corners& c) {
  return std::sqrt(std::max({squared_length(c[1] - c[0]), squared_length(c[2] - c[1]), squared_length(c[0] - c[2])}));
}

// Distance from M_l at which points of the image of a triangle may be, the longest side of which is `side`.
double lost_by_collapse(const Triangle& image, const Cell& cell, const std::vector<Edge>& edges, double side) {
  const Corners corners = corners_of(image, cell);
  if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]) return 0;
  for (std::size_t k = 0; k < 3; ++k)
    if (std::binary_search(edges.begin(), edges.end(), edge_of(image, k))) return 0;
  // No point of a triangle is farther from the nearest corner than its longest side over the root of 3.
  return std::min(0.5 * longest_side(corners), side / std::sqrt(3.0));
}

}  // namespace

double image_bound(const Hierarchy& hierarchy, CellId cell, CellRank first, CellRank end) {
  const Cell& above = hierarchy.cells[cell];
  const std::vector<Edge> edges = edges_of(above);
  double bound = 0;
  for (CellRank rank = first; rank < end; ++rank) {
    const CellId id = hierarchy.levels.back().id_of(rank);
    const Cell& below = hierarchy.cells[id];
    const std::vector<std::uint32_t> images = images_in(hierarchy, cell, id);
    for (const Triangle& t : below.triangles) {
      const Triangle image = image_of(t, images);
      const Corners from = corners_of(t, below), to = corners_of(image, above);
      const double way = std::max({length(to[0] - from[0]), length(to[1] - from[1]), length(to[2] - from[2])});
      bound = std::max(bound, way + lost_by_collapse(image, above, edges, longest_side(from)));
    }
  }
  return bound;
}

}  // namespace lodestone
