#include "render/position_map/position_map.h"

namespace lodestone {

PositionMap without_gaps(const PositionMap& map) {
  PixelMarks marks(map.view.width, map.view.height);
  const auto width = static_cast<std::size_t>(map.view.width);
  for (int y = 0; y < map.view.height; ++y)
    marks.add_row(0, map.view.width, y,
                  [&](int x) { return map.sees(static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)); });
  const PixelArray<std::uint8_t> groups(marks.groups());
  return {.view = map.view,
          .transform = map.transform,
          .position = map.position.in(groups),
          .triangle = map.triangle.in(groups, no_triangle),
          .depth = map.depth.in(groups),
          .normal = map.normal.in(groups),
          .uv = map.uv.in(groups),
          .colour = map.colour.in(groups, Rgba8{0, 0, 0, 0})};
}

}  // namespace lodestone
