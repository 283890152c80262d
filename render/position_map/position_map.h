// The part of a model that one view sees, pixel by pixel: its object-space positions as a float image (after Deng et
// al., see docs/decisions/0020), with further attributes.
#pragma once

#include <cstdint>

#include "core/math/vec3.h"
#include "core/mesh/attributes.h"
#include "core/mesh/indexed_mesh.h"
#include "render/position_map/map_view.h"
#include "render/position_map/pixel_array.h"

namespace lodestone {

inline constexpr std::uint32_t no_triangle = 0xFFFF'FFFFu;

// Every array has one value per pixel, row by row from the top, or none at all where the map does not have it.
// `triangle` and `depth` are always there, and all but the cheapest maps have `position` and `normal`. A pixel where
// nothing is seen is zero but for its triangle.
struct PositionMap {
  MapView view;
  Transform transform;                 // from normalised to model space
  PixelArray<Vec3f> position;          // normalised model space
  PixelArray<std::uint32_t> triangle;  // of the mesh that was drawn; no_triangle: nothing is seen
  PixelArray<float> depth;             // along view.forward, normalised units
  PixelArray<Vec3f> normal;  // of the triangle, of unit length or zero, on the side that the mesh calls outside
  PixelArray<Vec2f> uv;
  PixelArray<Rgba8> colour;

  [[nodiscard]] const PixelGroups& groups() const { return triangle.groups(); }
  [[nodiscard]] bool sees(std::size_t pixel) const { return triangle[pixel] != no_triangle; }
  friend bool operator==(const PositionMap&, const PositionMap&) = default;
};

// The same map with memory only for what is seen and the pixels beside it.
[[nodiscard]] PositionMap without_gaps(const PositionMap& map);

// Channels that are drawn besides triangle and depth.
struct MapChannels {
  bool uv = false, colour = false;  // where the mesh has them
  bool surface = true;              // position and normal
};

// Draws position maps of one mesh, by either backend.
class MapRenderer {
 public:
  virtual ~MapRenderer() = default;
  // Throws InputError for a view that check_view refuses or that has vertices behind its eye, UnsupportedError for one
  // that is larger than the backend's pictures.
  [[nodiscard]] virtual PositionMap draw(const MapView& view, MapChannels channels) = 0;
};

}  // namespace lodestone
