// Legends, as plain data: the meaning of the colours of a picture.
#pragma once

#include <string>
#include <vector>

#include "render/viewer/controls/view_settings.h"
#include "render/viewer/session/error_map.h"

namespace lodestone::viewer {

struct Legend {
  struct Entry {
    Vec3f colour;
    std::string label;  // empty: between its neighbours
    friend bool operator==(const Entry&, const Entry&) = default;
  };
  std::string title;
  std::vector<Entry> entries;
};

// Those of a frame that was drawn with these settings, none where the surface has its own colours: the levels that are
// drawn, triangles over a pixel, errors of a range, or the share of the finer level in the blending band; besides, the
// radii of cells whose boxes are shown.
[[nodiscard]] std::vector<Legend> legends_of(const ViewSettings& settings, const Frame& frame,
                                             const HeatRange& errors = {}, const HeatRange& radii = {});

}  // namespace lodestone::viewer
