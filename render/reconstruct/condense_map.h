// A map of twice the resolution, condensed: as many samples as wanted, but chosen with a view to what lies between.
//
// A mesh whose vertices lie on the surface lies inside of it wherever it is convex. The samples between two pixels tell
// by how much, and each pixel moves along its ray by the mean of what its neighbourhood is off: for a smooth surface the
// best fit in the mean, with less than half of the error. They also tell whether two pixels are connected at all: they
// are when both are connected with the one between them.
//
// A kernel: rows of one map, no threads.
#pragma once

#include <cstdint>
#include <vector>

#include "render/reconstruct/view_mesh.h"

namespace lodestone {

// The view to draw for a condensed map of `view`: pixels of half the side; pixel (x, y) of the result is (2x, 2y).
[[nodiscard]] MapView finer_view(const MapView& view);

struct CondenseConfig {
  ConnectConfig connect;          // for the finer map
  float crease_cosine = 0.819f;   // normals further apart (35 degrees) lie on two sides of a sharp feature: no mean of them
  float farthest = 0.5f;          // a pixel moves by so many spacings at most
};

struct CondensedMap {
  PositionMap map;
  std::vector<std::uint8_t> links;  // LinkBits
};

// Room for the result; `view` is that of the result.
[[nodiscard]] CondensedMap condensed_like(const PositionMap& fine, const MapView& view);
// Rows [first, last) of the result. Disjoint rows may be made at once.
void condense_rows(const PositionMap& fine, const CondenseConfig& config, int first, int last, CondensedMap& result);

}  // namespace lodestone
