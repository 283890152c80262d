// Light, background, effects and visibility that the user chose, and the frames that follow from them.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "core/mesh/up_axis.h"
#include "render/effects/plan.h"
#include "tests/render/viewer/two_tori.h"

namespace lodestone::viewer {
namespace {

TEST(Looks, AreThoseOfTheSceneAtFirst) {
  Scene scene;
  EXPECT_EQ(looks_of(scene), Looks{});
  scene.settings.background = {1, 0, 0};
  scene.settings.lighting.directional = {0.7f, true, 512};
  scene.towards_light = {1, 2, 3};
  const Looks looks = looks_of(scene);
  EXPECT_EQ(looks.background, scene.settings.background);
  EXPECT_EQ(looks.lighting, scene.settings.lighting);
  EXPECT_EQ(looks.towards_light, scene.towards_light);
  EXPECT_EQ(clamped(looks), looks);
}

TEST(Looks, AreBroughtIntoRange) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  Looks wild;
  wild.lighting = {nan, -3, {1e9f, true, 2048}};
  wild.towards_light = {0, 0, 0};
  wild.background = {nan, 2, -1};
  wild.fog.density = -1;
  wild.ambient_occlusion = {7, nan};
  const Looks tame = clamped(wild);
  EXPECT_EQ(tame.lighting.ambient, Looks{}.lighting.ambient);
  EXPECT_EQ(tame.lighting.head, 0);
  EXPECT_EQ(tame.lighting.directional.strength, 10);
  EXPECT_EQ(tame.towards_light, Looks{}.towards_light);
  EXPECT_EQ(tame.background, (Vec3f{FrameSettings{}.background.x, 1, 0}));
  EXPECT_EQ(tame.fog.density, 0);
  EXPECT_EQ(tame.ambient_occlusion.strength, 1);
  EXPECT_EQ(tame.ambient_occlusion.radius, 0);
}

TEST(Looks, BearingsAreDirections) {
  for (const Vec3d up : {Vec3d{0, 0, 1}, Vec3d{0, 3, 0}, Vec3d{1, 0, 0}, Vec3d{1, -2, 0.5}}) {
    EXPECT_LT(length(direction_of({12, 90}, up) - (1 / length(up)) * up), 1e-12);
    for (const double around : {-170.0, -90.0, 0.0, 45.0})
      for (const double above : {-80.0, 0.0, 30.0}) {
        const Vec3d direction = direction_of({around, above}, up);
        EXPECT_NEAR(length(direction), 1, 1e-12);
        const Bearing back = bearing_of(4.0 * direction, up);
        EXPECT_NEAR(back.around, around, 1e-9);
        EXPECT_NEAR(back.above, above, 1e-9);
      }
  }
  EXPECT_EQ(bearing_of({0, 0, 0}, {0, 0, 1}).above, 0);
}

class LooksDrawn : public test::TwoTori {
 protected:
  std::set<std::size_t> models_seen() {
    std::set<std::size_t> seen;
    for (int y = 0; y < size.height; y += 7)
      for (int x = 0; x < size.width; x += 7)
        if (const auto surface = drawing_.surface_at(0, size, x, y)) seen.insert(surface->model);
    return seen;
  }
};

TEST_F(LooksDrawn, HiddenModelsAreNotDrawn) {
  state_.looks.lighting.directional = {0.8f, true, 256};
  const Image both = draw();
  EXPECT_EQ(models_seen(), (std::set<std::size_t>{0, 1}));
  for (const std::size_t hidden : {0u, 1u}) {
    show(state_.looks, hidden, false);
    EXPECT_NE(draw().rgba, both.rgba);
    EXPECT_EQ(models_seen(), (std::set<std::size_t>{1 - hidden}));
    EXPECT_EQ(drawing_.frame(0).models[hidden].casters, nullptr);  // nor do they throw shadows
    show(state_.looks, hidden, true);
    EXPECT_EQ(draw().rgba, both.rgba);
  }
  for (const std::size_t hidden : {0u, 1u}) show(state_.looks, hidden, false);
  const Image none = draw();
  EXPECT_TRUE(std::ranges::all_of(none.depth, [](float depth) { return depth == 1; }));
}

TEST_F(LooksDrawn, FrozenModelsCanBeHidden) {
  apply(Action::toggle_frozen, state_);
  const Image both = draw();
  show(state_.looks, 0, false);
  EXPECT_NE(draw().rgba, both.rgba);
  EXPECT_EQ(models_seen(), (std::set<std::size_t>{1}));
  show(state_.looks, 0, true);
  EXPECT_EQ(draw().rgba, both.rgba);
}

TEST_F(LooksDrawn, LightBackgroundAndEffectsChangeThePicture) {
  const Image plain = draw();
  EXPECT_FALSE(drawing_.draw(state_, 0, size));
  const Looks before = state_.looks;
  std::vector<std::vector<std::uint8_t>> pictures{plain.rgba};
  const auto differs = [&] {  // from all pictures so far
    const std::vector<std::uint8_t> picture = draw().rgba;
    const bool is_new = std::ranges::find(pictures, picture) == pictures.end();
    pictures.push_back(picture);
    state_.looks = before;
    return is_new && draw().rgba == plain.rgba;
  };
  state_.looks.background = {1, 1, 1};
  EXPECT_TRUE(differs());
  state_.looks.lighting.ambient = 1;
  EXPECT_TRUE(differs());
  state_.looks.lighting.directional.strength = 0.9f;
  EXPECT_TRUE(differs());
  state_.looks.lighting.directional.strength = 0.9f;
  state_.looks.towards_light = {0, 0, -1};
  EXPECT_TRUE(differs());
  state_.looks.fog.density = 0.2f;
  EXPECT_TRUE(differs());
  state_.looks.ambient_occlusion = {0.9f, 0.2f};
  EXPECT_TRUE(differs());
  state_.looks.without.insert(Effect::smooth_normals);
  EXPECT_TRUE(differs());
  state_.looks.without.insert(Effect::geomorph);
  EXPECT_TRUE(differs());
}

TEST_F(LooksDrawn, WithoutHoldsForEveryRequest) {
  (void)draw();
  Frame frame = drawing_.frame(0);
  for (EffectRequest request : {parse_effects("auto"), parse_effects("all"), parse_effects("head-light,fog")}) {
    plan_effects(frame, request);
    EXPECT_TRUE(frame.all_effects().contains(Effect::head_light));
    request.without.insert(Effect::head_light);
    plan_effects(frame, request);
    EXPECT_FALSE(frame.all_effects().contains(Effect::head_light));
  }
}

}  // namespace
}  // namespace lodestone::viewer
