// Drawing position maps of one mesh, by either backend.
#pragma once

#include "render/position_map/position_map.h"

namespace lodestone {

class MapRenderer {
 public:
  virtual ~MapRenderer() = default;
  // Throws InputError for a view that check_view refuses or that has vertices behind its eye, UnsupportedError for one
  // that is larger than the backend's pictures.
  [[nodiscard]] virtual PositionMap draw(const MapView& view, MapChannels channels) = 0;
};

}  // namespace lodestone
