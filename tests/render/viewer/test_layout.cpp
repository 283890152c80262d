// Places of the panel and the pictures in the window, and the size of text.
#include <gtest/gtest.h>

#include "render/viewer/controls/layout.h"

namespace lodestone::viewer {
namespace {

TEST(Layout, LayoutsFillTheWindow) {
  ViewState state;
  state.panel = false;
  const std::vector<ViewRect> one = layout(state, {640, 480});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].rect, (Rect{0, 0, 640, 480}));
  state.chosen = 1;
  EXPECT_EQ(layout(state, {640, 480})[0].settings, 1u);
  state.split = true;
  const std::vector<ViewRect> two = layout(state, {642, 480});
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].rect, (Rect{0, 0, 320, 480}));
  EXPECT_EQ(two[1].rect, (Rect{322, 0, 320, 480}));
  EXPECT_TRUE(two[1].rect.contains(322, 0));
  EXPECT_FALSE(two[1].rect.contains(321.9, 0));
}

TEST(Layout, WindowsWithoutPixelsShowNothing) {
  for (const bool split : {false, true}) {
    ViewState state;
    state.split = split;
    for (const ImageSize size : {ImageSize{0, 0}, ImageSize{0, 10}, ImageSize{10, 0}, ImageSize{-1, 5}})
      EXPECT_TRUE(layout(state, size).empty());
    for (int width = 1; width < 12; ++width)
      for (const ViewRect& view : layout(state, {width, 1})) {
        EXPECT_GE(view.rect.width, 1);
        EXPECT_LE(view.rect.x + view.rect.width, width);
      }
  }
}

TEST(Layout, ThePanelCoversNoPicture) {
  for (const bool split : {false, true})
    for (const float scale : {1.0f, 1.5f, 4.0f})
      for (const ImageSize window :
           {ImageSize{40, 300}, ImageSize{642, 480}, ImageSize{1280, 720}, ImageSize{3840, 2160}}) {
        ViewState state;
        state.split = split;
        state.scale = scale;
        const Rect panel = panel_rect(state, window), pictures = pictures_rect(state, window);
        EXPECT_EQ(panel.x + panel.width, pictures.x);
        EXPECT_EQ(pictures.x + pictures.width, window.width);
        EXPECT_GT(panel.width, 0);
        EXPECT_LT(panel.width, pictures.width);
        for (const ViewRect& view : layout(state, window)) EXPECT_GE(view.rect.x, panel.width);
        state.panel = false;
        EXPECT_EQ(pictures_rect(state, window), (Rect{0, 0, window.width, window.height}));
      }
}

TEST(Layout, TextGrowsWithTheWindow) {
  EXPECT_EQ(interface_scale({642, 480}, 1), 1);
  EXPECT_EQ(interface_scale({1280, 720}, 1), 1);
  EXPECT_EQ(interface_scale({1920, 1080}, 1), 1.5f);
  EXPECT_EQ(interface_scale({1920, 720}, 1), 1);  // as high as before
  EXPECT_EQ(interface_scale({7680, 4320}, 1), 2);
  EXPECT_EQ(interface_scale({1280, 720}, 2), 2);  // a dense screen
  EXPECT_EQ(interface_scale({0, 0}, 1), 1);
}

}  // namespace
}  // namespace lodestone::viewer
