#include "render/viewer/controls/layout.h"

#include <algorithm>
#include <cmath>

namespace lodestone::viewer {
namespace {

constexpr ImageSize usual_window{1280, 720};
constexpr float panel_width = 270;      // at scale 1, pixels
constexpr float largest_share = 0.45f;  // of the window's width, for the panel

}  // namespace

float interface_scale(ImageSize window, float density) {
  const float fitting = std::min(static_cast<float>(window.width) / static_cast<float>(usual_window.width),
                                 static_cast<float>(window.height) / static_cast<float>(usual_window.height));
  constexpr float steps = 8;  // few sizes of text, so that dragging a window's edge makes few fonts
  return std::floor(std::clamp(fitting, density, 2 * density) * steps) / steps;
}

Rect panel_rect(const ViewState& state, ImageSize window) {
  if (!state.panel || window.width < 1 || window.height < 1) return {};
  const float width = std::min(panel_width * state.scale, largest_share * static_cast<float>(window.width));
  return {0, 0, static_cast<int>(width), window.height};
}

Rect pictures_rect(const ViewState& state, ImageSize window) {
  const int left = panel_rect(state, window).width;
  return {left, 0, std::max(0, window.width - left), std::max(0, window.height)};
}

std::vector<ViewRect> layout(const ViewState& state, ImageSize window) {
  const Rect all = pictures_rect(state, window);
  if (all.width < 1 || all.height < 1) return {};
  if (!state.split) return {{state.chosen, all}};
  const int left = (all.width - split_gap) / 2, right = all.width - split_gap - left;
  std::vector<ViewRect> views;
  if (left > 0) views.push_back({0, {all.x, 0, left, all.height}});
  if (right > 0 && left >= 0) views.push_back({1, {all.x + left + split_gap, 0, right, all.height}});
  return views;
}

}  // namespace lodestone::viewer
