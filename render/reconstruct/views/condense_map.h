// Condenses a map of twice the resolution: to the wanted number of samples, using the finer ones between them.
//
// The finer samples tell whether two pixels are connected: they are when both are connected with the one between. And
// they tell the best place of a vertex: a mesh whose vertices lie on the surface is inside of it wherever it is convex,
// and cuts off sharp features. Each pixel's vertex is placed where the sum of its squared distances from the tangent
// planes of its 3x3 finer samples is minimal (the quadrics of garland1997, as in the cells of ju2002): for a smooth
// surface off it by the mean error of the triangles around, which more than halves their mean error; at an edge or a
// corner, on it.
//
// A kernel: rows of one map, no threads.
#pragma once

#include <cstdint>

#include "render/reconstruct/views/view_mesh.h"

namespace lodestone {

// The view to draw for a condensed map of `view`: pixels of half the side; pixel (x, y) of the result is (2x, 2y).
[[nodiscard]] MapView finer_view(const MapView& view);

struct CondenseConfig {
  ConnectConfig connect;  // for the finer map
  float crease_cosine =
      0.819f;               // normals further apart (35 degrees) lie on two sides of a sharp feature: no mean of them
  float stiffness = 0.02f;  // against moving where the planes say little, over the weight of the planes; > 0
  float farthest = 0.35f;   // maximum sideways displacement of a vertex, in spacings; along the ray, twice that
};

struct CondensedMap {
  PositionMap map;
  PixelArray<std::uint8_t> links;  // LinkBits, and on_feature where a vertex was put on an edge or a corner
  PixelArray<Vec3f> vertex;        // normalised model space
};

inline constexpr std::uint8_t on_feature = 16;

// Room for the result; `view` is that of the result.
[[nodiscard]] CondensedMap condensed_like(const PositionMap& fine, const MapView& view);
// Rows [first, last) of the result. Disjoint rows may be made at once.
void condense_rows(const PositionMap& fine, const CondenseConfig& config, int first, int last, CondensedMap& result);

}  // namespace lodestone
