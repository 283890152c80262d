// Switches, settings, layouts, mouse and keys of the viewer; its resolution.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "core/base/error.h"
#include "render/camera/camera.h"
#include "render/viewer/controls/camera_control.h"
#include "render/viewer/controls/navigation.h"
#include "render/viewer/controls/view_state.h"
#include "render/viewer/session/frame_times.h"
#include "render/viewer/session/resolution.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone::viewer {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

const Hierarchy& torus() {
  static const auto small = test::naive_hierarchy(test::torus_mesh(64, 32), 2);
  return small.hierarchy;
}

std::span<const Hierarchy* const> all() {
  static const Hierarchy* const only = &torus();
  return {&only, 1};
}

ViewState looking_at_torus() {
  ViewState state;
  look_at(state, bounding_sphere(torus()), orbit_path(torus(), 1).front());
  return state;
}

// ---- state ----

TEST(ViewState, EveryKeyHasOneAction) {
  std::set<char> keys;
  std::set<Action> actions;
  for (const ActionKey& key : action_keys()) {
    EXPECT_TRUE(keys.insert(key.key).second) << key.name;
    EXPECT_TRUE(actions.insert(key.action).second) << key.name;
    EXPECT_EQ(action_of(key.key), key.action);
    EXPECT_EQ(std::string_view("WASDQE").find(key.key), std::string_view::npos) << key.name;
  }
  EXPECT_EQ(action_of('='), Action::finer);
  EXPECT_EQ(action_of('#'), std::nullopt);
}

TEST(ViewState, SwitchesSwitchTheChosenSettings) {
  using Switch = bool ViewSettings::*;
  for (const auto& [action, which] : {std::pair<Action, Switch>{Action::toggle_tint, &ViewSettings::tint},
                                      {Action::toggle_errors, &ViewSettings::errors},
                                      {Action::toggle_band, &ViewSettings::band},
                                      {Action::toggle_boxes, &ViewSettings::boxes},
                                      {Action::toggle_wireframe, &ViewSettings::wireframe},
                                      {Action::toggle_overdraw, &ViewSettings::overdraw}}) {
    ViewState state = looking_at_torus();
    apply(Action::choose_other, state);
    apply(action, state);
    EXPECT_TRUE(state.settings[1].*which);
    EXPECT_FALSE(state.settings[0].*which);
    apply(action, state);
    EXPECT_EQ(state.settings[1], ViewSettings{});
  }
}

TEST(ViewState, FreezingRemembersTheCamera) {
  ViewState state = looking_at_torus();
  const Camera before = state.camera;
  apply(Action::toggle_frozen, state);
  state.camera = orbit(state.camera, 1, 0);
  EXPECT_TRUE(state.frozen);
  EXPECT_EQ(state.frozen_from, before);
  apply(Action::toggle_frozen, state);
  apply(Action::toggle_frozen, state);
  EXPECT_EQ(state.frozen_from, state.camera);
  EXPECT_EQ(state.freezes, 2u);
  look_at(state, bounding_sphere(torus()), orbit_path(torus(), 1).front());
  EXPECT_FALSE(state.frozen);
}

TEST(ViewState, CoarserAndFinerStayInRange) {
  ViewState state = looking_at_torus();
  apply(Action::coarser, state);
  EXPECT_FLOAT_EQ(state.current().pixel_error, std::sqrt(2.0f));
  for (int i = 0; i < 100; ++i) apply(Action::finer, state);
  EXPECT_EQ(state.current().pixel_error, 0.05f);
  state.current().by_kappa0 = true;
  apply(Action::coarser, state);
  EXPECT_FLOAT_EQ(state.current().kappa0, 3 / std::sqrt(2.0f));
  for (int i = 0; i < 100; ++i) apply(Action::finer, state);
  EXPECT_EQ(state.current().kappa0, 1000);
}

// ---- settings ----

TEST(ViewSettings, AreBroughtIntoRange) {
  ViewSettings wild;
  wild.pixel_error = nan;
  wild.kappa0 = -3;
  wild.beta = std::numeric_limits<float>::infinity();
  wild.samples = 7;
  const ViewSettings tame = clamped(wild);
  EXPECT_EQ(tame.pixel_error, 1);
  EXPECT_EQ(tame.kappa0, 0.01f);
  EXPECT_EQ(tame.beta, RadiiConfig{}.beta);
  EXPECT_EQ(tame.samples, 1);
  EXPECT_EQ(clamped(tame), tame);
  for (const bool by_kappa0 : {false, true}) {
    wild.by_kappa0 = by_kappa0;
    EXPECT_NO_THROW((void)make_radii(torus(), for_picture(radii_config(wild, DistanceMetric::euclidean), {1, 1}, 0.7)));
  }
}

TEST(ViewSettings, InadmissibleValuesAreMarked) {
  for (const DistanceMetric metric : {DistanceMetric::euclidean, DistanceMetric::chebyshev}) {
    const float rho = greatest_reach(torus(), metric);
    ViewSettings settings;
    settings.by_kappa0 = true;
    settings.rule = RadiiRule::uniform;
    settings.kappa0 = 0.9f * rho;
    const Admissibility below = admissibility(all(), settings, metric);
    EXPECT_FALSE(below.admissible);
    EXPECT_EQ(below.least_kappa0, rho);
    EXPECT_NE(below.remark.find("cracks"), std::string::npos);
    settings.kappa0 = 1.1f * rho;
    EXPECT_TRUE(admissibility(all(), settings, metric).admissible);
    EXPECT_EQ(admissibility(all(), settings, metric).remark, "");
    settings.kappa0 = 0.9f * rho;
    settings.rule = RadiiRule::per_level;
    EXPECT_TRUE(admissibility(all(), settings, metric).admissible);
  }
  ViewSettings pops;
  pops.blend = Blend::step;
  EXPECT_FALSE(admissibility(all(), pops, DistanceMetric::euclidean).continuous);
  EXPECT_NE(admissibility(all(), pops, DistanceMetric::euclidean).remark.find("pop"), std::string::npos);
}

TEST(ViewSettings, ATolerancesRadiiAreThoseOfRender) {
  ViewSettings settings;
  settings.pixel_error = 2;
  settings.rule = RadiiRule::uniform;  // of kappa0 alone
  RadiiConfig expected;
  expected.pixel_error = 2;
  expected.image_height = 300;
  expected.aspect = 400.0f / 300.0f;
  expected.vertical_fov = 0.7f;
  EXPECT_EQ(make_radii(torus(), for_picture(radii_config(settings, DistanceMetric::euclidean), {400, 300}, 0.7)).select,
            make_radii(torus(), expected).select);
  settings.rule = RadiiRule::adaptive;  // of the tolerance alone
  EXPECT_EQ(radii_config(settings, DistanceMetric::euclidean).rule, RadiiRule::adaptive);
  EXPECT_TRUE(admissibility(all(), settings, DistanceMetric::euclidean).admissible);
  settings.by_kappa0 = true;
  EXPECT_EQ(radii_config(settings, DistanceMetric::euclidean).rule, RadiiRule::per_level);
}

// ---- mouse and keys ----

TEST(Navigation, DragsOrbitPanAndLook) {
  for (const Button button : {Button::left, Button::right, Button::middle}) {
    for (const Steering steering : {Steering::orbit, Steering::fly}) {
      ViewState state = looking_at_torus();
      state.steering = steering;
      const Camera before = state.camera;
      Navigation navigation;
      navigation.move(state, {50, 50}, 480);
      EXPECT_EQ(state.camera, before);  // nothing is pressed
      navigation.press(button, {100, 100}, 0);
      navigation.move(state, {102, 101}, 480);
      EXPECT_EQ(state.camera, before);  // an unsteady click
      navigation.move(state, {160, 140}, 480);
      EXPECT_NE(state.camera, before);
      EXPECT_EQ(state.camera.target == before.target, button == Button::left && steering == Steering::orbit);
      EXPECT_EQ(state.camera.position == before.position, button == Button::left && steering == Steering::fly);
      const Camera after = state.camera;
      navigation.release(button, {160, 140}, 0.2);
      navigation.move(state, {10, 10}, 480);
      EXPECT_EQ(state.camera, after);
      EXPECT_EQ(navigation.take_focus(), std::nullopt);
    }
  }
}

TEST(Navigation, TheFirstButtonDecides) {
  Navigation navigation;
  navigation.press(Button::left, {100, 100}, 0);
  navigation.press(Button::right, {100, 100}, 0.1);
  navigation.release(Button::right, {100, 100}, 0.2);
  EXPECT_TRUE(navigation.dragging());
  navigation.let_go();
  EXPECT_FALSE(navigation.dragging());
}

TEST(Navigation, DoubleClicksFocus) {
  Navigation navigation;
  const auto click = [&](Point at, double when) {
    navigation.press(Button::left, at, when);
    navigation.release(Button::left, at, when + 0.05);
  };
  click({10, 20}, 0);
  EXPECT_EQ(navigation.take_focus(), std::nullopt);
  click({11, 20}, 0.2);
  EXPECT_EQ(navigation.take_focus(), (Point{11, 20}));
  EXPECT_EQ(navigation.take_focus(), std::nullopt);  // once
  click({11, 20}, 0.4);
  EXPECT_EQ(navigation.take_focus(), std::nullopt);  // the third click begins anew
  click({11, 20}, 2);
  EXPECT_EQ(navigation.take_focus(), std::nullopt);  // too late
  click({90, 20}, 2.2);
  EXPECT_EQ(navigation.take_focus(), std::nullopt);  // elsewhere
}

TEST(Navigation, WheelsZoomOrChangeTheSpeed) {
  ViewState state = looking_at_torus();
  Navigation navigation;
  const double before = length(state.camera.position - state.camera.target);
  navigation.scroll(state, 1);
  EXPECT_LT(length(state.camera.position - state.camera.target), before);
  navigation.scroll(state, -1);
  EXPECT_NEAR(length(state.camera.position - state.camera.target), before, 1e-12);
  navigation.scroll(state, std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(is_valid(state.camera));
  state.steering = Steering::fly;
  const double speed = state.fly_speed;
  navigation.scroll(state, 1);
  EXPECT_GT(state.fly_speed, speed);
}

TEST(Navigation, KeysFly) {
  ViewState state = looking_at_torus();
  Navigation navigation;
  EXPECT_FALSE(navigation.key(state, {.key = 'W', .pressed = true}));  // not while orbiting
  state.steering = Steering::fly;
  EXPECT_FALSE(navigation.flying(state));
  EXPECT_FALSE(navigation.key(state, {.key = 'T', .pressed = true}));
  EXPECT_TRUE(navigation.key(state, {.key = 'W', .pressed = true}));
  EXPECT_TRUE(navigation.flying(state));
  const Camera before = state.camera;
  navigation.advance(state, 0.1);
  EXPECT_NEAR(length(state.camera.position - before.position), 0.1 * state.fly_speed, 1e-12);
  EXPECT_TRUE(navigation.key(state, {.key = 'S', .pressed = true}));  // both: nowhere
  EXPECT_FALSE(navigation.flying(state));
  EXPECT_TRUE(navigation.key(state, {.key = 'W'}));
  navigation.advance(state, 0.1);
  EXPECT_LT(length(state.camera.position - before.position), 1e-12);
  EXPECT_TRUE(navigation.key(state, {.key = 'D', .pressed = true, .shift = true}));
  state.camera = before;
  navigation.advance(state, 100);  // a frame that took far too long does not make the camera leap
  EXPECT_LT(length(state.camera.position - before.position), 2 * state.fly_speed);
  navigation.let_go();
  EXPECT_FALSE(navigation.flying(state));
}

// ---- resolution and times ----

TEST(Resolution, IsLoweredOnlyWhileSlowFramesMove) {
  ResolutionGovernor governor(30);
  EXPECT_EQ(governor.scale(0), 1);
  governor.drawn(1, 120);  // four times too slow: half of either side
  EXPECT_EQ(governor.scale(0), 1);
  governor.moved(10);
  EXPECT_EQ(governor.scale(10.1), 0.5);
  EXPECT_GT(governor.until_rest(10.1), 0);
  EXPECT_EQ(governor.scale(10.2), 1);
  EXPECT_EQ(governor.until_rest(10.2), 0);
}

TEST(Resolution, RisesInStepsWithRoomToSpare) {
  ResolutionGovernor governor(30);
  governor.moved(0);
  governor.drawn(1, 10000);
  EXPECT_EQ(governor.scale(0), ResolutionGovernor::least_scale);
  governor.drawn(0.25, 28);  // near enough: it is kept
  EXPECT_EQ(governor.scale(0), 0.25);
  double before = 0.25;
  for (int i = 0; i < 10; ++i) {
    governor.drawn(before, 1);
    EXPECT_LE(governor.scale(0), before + 0.125);
    EXPECT_GE(governor.scale(0), before);
    before = governor.scale(0);
  }
  EXPECT_EQ(before, 1);
}

TEST(Resolution, TimesThatAreNoneChangeNothing) {
  ResolutionGovernor governor;
  governor.moved(0);
  for (const double wrong : {0.0, -1.0, static_cast<double>(nan)}) governor.drawn(1, wrong);
  EXPECT_EQ(governor.scale(0), 1);
}

TEST(FrameTimes, KeepTheLastOnesInOrder) {
  FrameTimes times;
  EXPECT_TRUE(times.in_order().empty());
  for (int i = 0; i < 200; ++i) times.add(i);
  const std::vector<float> kept = times.in_order();
  ASSERT_EQ(kept.size(), 120u);
  EXPECT_EQ(kept.front(), 80);
  EXPECT_EQ(kept.back(), 199);
  EXPECT_EQ(times.last(), 199);
}

}  // namespace
}  // namespace lodestone::viewer
