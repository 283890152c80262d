// The clipping plane: the plane of a choice, and the pictures of both backends against what lies behind it.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "render/viewer/controls/camera_control.h"
#include "tests/render/viewer/two_tori.h"

namespace lodestone::viewer {
namespace {

TEST(ClipChoice, IsAPlaneAcrossTheScene) {
  const Sphere scene{{1, 2, 3}, 4};
  ClipChoice choice;
  EXPECT_EQ(plane_of(choice, scene), std::nullopt);
  choice.on = true;
  choice.axis = 1;
  choice.place = 0.5f;  // y = 4
  const auto kept = [&](Vec3d p) {
    const ClipPlane plane = *plane_of(choice, scene);
    return dot(plane.normal, p) >= plane.offset;
  };
  EXPECT_TRUE(kept({9, 3.9, 9}));
  EXPECT_FALSE(kept({-9, 4.1, -9}));
  choice.other = true;
  EXPECT_FALSE(kept({9, 3.9, 9}));
  EXPECT_TRUE(kept({-9, 4.1, -9}));
  choice.place = std::nanf("");
  EXPECT_TRUE(kept({0, 2.1, 0}));
  EXPECT_FALSE(kept({0, 1.9, 0}));
}

TEST(ClipChoice, BoxesAreOnASideOrAcross) {
  const Plane plane{{1, -1, 0}, 0.5f};  // x - y + 0.5 >= 0
  EXPECT_EQ(side_of(plane, {{0, 0, 0}, {0.4f, 0.4f, 1}}), 1);
  EXPECT_EQ(side_of(plane, {{0, 0, 0}, {1, 1, 1}}), 0);
  EXPECT_EQ(side_of(plane, {{0, 2, 0}, {1, 3, 1}}), -1);
}

class ClipDrawn : public test::TwoTori, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    try {
      own_ = make_renderer(GetParam(), *scheduler_);
    } catch (const UnsupportedError& error) {
      GTEST_SKIP() << error.what();
    }
    drawing_.set_renderer(own_.get());
  }
  Image picture() {
    (void)drawing_.draw(state_, 0, size);
    return own_->read_back();
  }
  // Pixels that disagree with the surface that a ray finds: drawn or not and, with one sample, how far away.
  int wrong_pixels(const Image& image) const {
    const auto plane = plane_of(state_.clip, drawing_.bounding_sphere());
    const bool central = state_.current().samples == 1;  // otherwise the depth is that of a sample beside the centre
    int wrong = 0;
    for (int y = 0; y < size.height; y += 5)
      for (int x = 0; x < size.width; x += 5) {
        const auto surface = drawing_.surface_at(0, size, x + 0.5, y + 0.5);
        const float depth = image.depth[static_cast<std::size_t>(y * size.width + x)];
        const bool drawn = depth < 1;
        wrong += surface.has_value() != drawn;
        if (!surface || !drawn) continue;
        const auto at = project(drawing_.frame(0).models[surface->model].view_projection, size, surface->point);
        wrong += central && std::abs(at->z - depth) > 1e-4;
        EXPECT_GE(dot(plane->normal, drawing_.in_scene(*surface)), plane->offset - 1e-5);
      }
    return wrong;
  }
  std::unique_ptr<Renderer> own_;
};

TEST_P(ClipDrawn, ShowsNothingBehindThePlane) {
  const Image plain = picture();
  for (const int samples : {1, 4})
    for (int axis = 0; axis < 3; ++axis)
      for (const bool other : {false, true}) {
        state_.current().samples = samples;
        state_.clip = {true, axis, 0.1f * static_cast<float>(axis), other};
        const Image clipped = picture();
        EXPECT_NE(clipped.rgba, plain.rgba);
        EXPECT_LT(wrong_pixels(clipped), 8) << axis << other << samples;  // along the cut
      }
  state_.current().samples = 1;
  state_.clip.on = false;
  EXPECT_EQ(picture().rgba, plain.rgba);
}

TEST_P(ClipDrawn, WorksWithEdgesCountsShadowsAndHeatMaps) {
  state_.clip = {true, 0, 0, false};
  state_.looks.lighting.directional = {0.8f, true, 256};
  for (bool ViewSettings::*looks : {&ViewSettings::wireframe, &ViewSettings::errors, &ViewSettings::tint}) {
    state_.current().*looks = true;
    EXPECT_LT(wrong_pixels(picture()), 8);
    state_.current().*looks = false;
  }
  state_.current().overdraw = true;
  const Image counts = picture();
  state_.clip.on = false;
  EXPECT_NE(picture().rgba, counts.rgba);
}

TEST_P(ClipDrawn, EndsLeaveAllOrNothing) {
  const Image plain = picture();
  state_.clip = {true, 2, 1, false};
  EXPECT_EQ(picture().rgba, plain.rgba);
  state_.clip.other = true;
  const Image nothing = picture();
  EXPECT_TRUE(std::ranges::all_of(nothing.depth, [](float depth) { return depth == 1; }));
}

TEST_P(ClipDrawn, CutsAFrozenSelectionToo) {
  apply(Action::toggle_frozen, state_);
  const Image plain = picture();
  apply(Action::toggle_clip, state_);
  EXPECT_LT(wrong_pixels(picture()), 8);
  apply(Action::toggle_clip, state_);
  EXPECT_EQ(picture().rgba, plain.rgba);
}

TEST_P(ClipDrawn, RefusesAPlaneThatIsNone) {
  (void)picture();
  Frame frame = drawing_.frame(0);
  frame.models[0].clip = Plane{{std::nanf(""), 0, 0}, 0};
  EXPECT_THROW((void)own_->draw(frame), InputError);
}

INSTANTIATE_TEST_SUITE_P(Backends, ClipDrawn, testing::Values("soft", "gl"));

}  // namespace
}  // namespace lodestone::viewer
