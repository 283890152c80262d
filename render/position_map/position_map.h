// The part of a model that one view sees, pixel by pixel: its object-space positions as a float image (after Deng et
// al., see docs/decisions/0020), with further attributes.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/vec2.h"
#include "core/math/vec3.h"
#include "core/mesh/attributes.h"
#include "core/mesh/indexed_mesh.h"
#include "render/position_map/map_view.h"

namespace lodestone {

inline constexpr std::uint32_t no_triangle = 0xFFFF'FFFFu;

// Every array has one entry per pixel, row by row from the top, or none at all where the map does not have it.
// `triangle` and `depth` are always there, and all but the cheapest maps have `position` and `normal`. A pixel where
// nothing is seen is zero but for its triangle.
struct PositionMap {
  MapView view;
  Transform transform;                  // from normalised to model space
  std::vector<Vec3f> position;          // normalised model space
  std::vector<std::uint32_t> triangle;  // of the mesh that was drawn; no_triangle: nothing is seen
  std::vector<float> depth;             // along view.forward, normalised units
  std::vector<Vec3f> normal;  // of the triangle, of unit length or zero, on the side that the mesh calls outside
  std::vector<Vec2f> uv;
  std::vector<Rgba8> colour;

  [[nodiscard]] bool sees(std::size_t pixel) const { return triangle[pixel] != no_triangle; }
  friend bool operator==(const PositionMap&, const PositionMap&) = default;
};

// Channels that are drawn besides triangle and depth.
struct MapChannels {
  bool uv = false, colour = false;  // where the mesh has them
  bool surface = true;              // position and normal
};

}  // namespace lodestone
