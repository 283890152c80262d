// Drawing position maps on the processor, all workers.
//
// Vertices are snapped to 1/256 pixel; coverage is decided by edge functions (pineda1988) in exact integers with the
// top-left rule, as in render/backends/soft, so that an edge that two triangles share leaves no pixel out. The nearest
// triangle is seen, of equally near ones the one with the lower number. Both sides of a triangle are drawn.
#pragma once

#include <cstdint>
#include <utility>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/position_map/position_map.h"

namespace lodestone {

// Gives the same bytes for any number of workers. Time: vertices + triangles + covered pixels + rows of triangles.
// Memory: 16 bytes a vertex, and 4 for each tile of 64x64 pixels that a triangle's box with a pixel's centre in it
// overlaps, besides the map, and for each pixel of these tiles. Without `surface` depths are interpolated from the
// corners' and no positions are computed: enough to decide visibility. Throws InputError for a view that check_view
// refuses, or when a vertex is not in front of the eye of a perspective view.
[[nodiscard]] PositionMap rasterize_map(const IndexedMesh& mesh, const MapView& view, MapChannels channels,
                                        Scheduler& scheduler);

// The pieces of it.

struct SnappedVertex {
  std::int32_t x = 0, y = 0;  // 1/256 pixel, y downwards; at most 2^29 in magnitude
  double z = 0;               // grows with depth and is linear in the window: depth, or -1/depth in perspective
};
[[nodiscard]] SnappedVertex snap_to_window(const MapView& view, Vec3f position);

// The edge functions of a triangle at (x, y), all in 1/256 pixel; each is twice the area of the triangle between the
// point and the edge opposite to the corner. Covered: all three are positive, or zero along a top or a left edge.
struct TriangleCoverage {
  explicit TriangleCoverage(const SnappedVertex& a, const SnappedVertex& b, const SnappedVertex& c);
  std::int64_t area = 0;  // doubled; 0: covers nothing
  [[nodiscard]] bool at(std::int64_t x, std::int64_t y, double& z) const;
  // The first and the last i, with 0 <= i < count, of which the point (first + step i, y) is covered, as are all
  // between them; the last is below the first if the row misses the triangle. Needles take no longer than what fills
  // its box.
  [[nodiscard]] std::pair<std::int64_t, std::int64_t> row(std::int64_t y, std::int64_t first, std::int64_t step,
                                                          std::int64_t count) const;
  // True if no point of the rectangle is covered; false does not say that one is.
  [[nodiscard]] bool misses(std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1) const;

 private:
  struct Edge {
    std::int64_t x = 0, y = 0, dx = 0, dy = 0, bias = 0;
  };
  Edge edge_[3];  // opposite to corner 0, 1, 2 after turning
  double z_[3];
};

}  // namespace lodestone
