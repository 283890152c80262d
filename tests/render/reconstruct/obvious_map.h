// The slow, obvious twin of rasterize_map: every triangle against every pixel. And small meshes to draw.
#pragma once

#include <limits>

#include "core/mesh/clean.h"
#include "render/position_map/rasterize_map.h"
#include "render/position_map/resolve_pixel.h"
#include "tests/test_meshes.h"

namespace lodestone::test {

// A pixel's centre is inside when it is on the inner side of all three edges, or on an edge that goes left (top, in a
// clockwise triangle with y downwards) or up.
inline bool obviously_covers(const SnappedVertex (&v)[3], std::int64_t x, std::int64_t y) {
  for (int k = 0; k < 3; ++k) {
    const SnappedVertex &a = v[k], &b = v[(k + 1) % 3];
    const std::int64_t side = std::int64_t{b.x - a.x} * (y - a.y) - std::int64_t{b.y - a.y} * (x - a.x);
    const bool top = a.y == b.y && b.x > a.x, left = b.y < a.y;
    if (side < 0 || (side == 0 && !top && !left)) return false;
  }
  return true;
}

inline PositionMap obvious_map(const IndexedMesh& mesh, const MapView& view, MapChannels channels = {}) {
  PositionMap map = empty_map(mesh, view, channels, PixelGroups::all(view.pixels()));
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
      double nearest = std::numeric_limits<double>::infinity();
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        SnappedVertex v[3];
        for (std::size_t k = 0; k < 3; ++k) v[k] = snap_to_window(view, mesh.positions[mesh.triangles[t].v[k]]);
        const std::int64_t area =
            std::int64_t{v[1].x - v[0].x} * (v[2].y - v[0].y) - std::int64_t{v[1].y - v[0].y} * (v[2].x - v[0].x);
        if (area == 0) continue;
        if (area < 0) std::swap(v[1], v[2]);
        if (!obviously_covers(v, 256 * x + 128, 256 * y + 128)) continue;
        double z = 0;
        const auto& c = mesh.triangles[t].v;
        (void)TriangleCoverage(snap_to_window(view, mesh.positions[c[0]]), snap_to_window(view, mesh.positions[c[1]]),
                               snap_to_window(view, mesh.positions[c[2]]))
            .at(256 * x + 128, 256 * y + 128, z);
        if (view.nearest > 0 && z < nearest_z(view)) continue;
        if (z < nearest) nearest = z, map.triangle[i] = t;
      }
      if (map.sees(i)) resolve_pixel(mesh, i, map);
    }
  return map;
}

inline Box3f box_of(const IndexedMesh& mesh) {
  Box3f box;
  for (const Vec3f& p : mesh.positions) box.extend(p);
  return box;
}

// n x n squares on each face of a box.
inline void add_box(Vec3d lo, Vec3d hi, std::uint32_t n, std::vector<Vec3d>& positions,
                    std::vector<Triangle>& triangles) {
  const auto place = [&](Vec3d p) {
    return Vec3d{lo.x + p.x * (hi.x - lo.x), lo.y + p.y * (hi.y - lo.y), lo.z + p.z * (hi.z - lo.z)};
  };
  add_cube(n, place, positions, triangles);
}

inline IndexedMesh clean(const std::vector<Vec3d>& positions, const std::vector<Triangle>& triangles) {
  RawMesh raw;
  raw.positions = positions, raw.triangles = triangles;
  Repairs repairs;
  return clean_mesh(raw, repairs);
}

}  // namespace lodestone::test
