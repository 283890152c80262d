// The places of the panel and of the pictures in the window. The panel is docked at the left; the pictures share the
// rest, so that it hides no part of a model.
#pragma once

#include <vector>

#include "render/viewer/controls/view_state.h"

namespace lodestone::viewer {

// Pixels of the window, from its upper left corner.
struct Rect {
  int x = 0, y = 0, width = 0, height = 0;
  [[nodiscard]] bool contains(double px, double py) const {
    return px >= x && py >= y && px < x + width && py < y + height;
  }
  [[nodiscard]] ImageSize size() const { return {width, height}; }
  friend bool operator==(const Rect&, const Rect&) = default;
};

// The size of text and controls, 1 being that of usual text: it grows with the window, up to twice the density of the
// screen. `density`: pixels of the picture to a usual one, at least 1.
[[nodiscard]] float interface_scale(ImageSize window, float density);

// The panel's place, without pixels where it is hidden. It takes less than half the window.
[[nodiscard]] Rect panel_rect(const ViewState& state, ImageSize window);

// The pictures' places, by settings: one, or two side by side with a line of `split_gap` pixels between them. A
// rectangle without pixels is not drawn.
inline constexpr int split_gap = 2;
struct ViewRect {
  std::size_t settings = 0;
  Rect rect;
};
[[nodiscard]] std::vector<ViewRect> layout(const ViewState& state, ImageSize window);
// All that is beside the panel.
[[nodiscard]] Rect pictures_rect(const ViewState& state, ImageSize window);

}  // namespace lodestone::viewer
