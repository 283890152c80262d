// How mouse and keys move a camera, and cameras in time.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "render/camera/camera.h"
#include "render/viewer/controls/camera_control.h"
#include "render/viewer/controls/camera_track.h"

namespace lodestone::viewer {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

Camera some_camera() { return {{4, 0, 0}, {1, 0, 0}}; }

double distance(Vec3d a, Vec3d b) { return length(a - b); }

void expect_near(Vec3d a, Vec3d b, double tolerance = 1e-12) { EXPECT_LT(distance(a, b), tolerance); }

TEST(CameraControl, OrbitKeepsTargetAndDistance) {
  const Camera camera = some_camera(), moved = orbit(camera, 0.3, -0.2);
  EXPECT_EQ(moved.target, camera.target);
  EXPECT_NEAR(distance(moved.position, moved.target), 3, 1e-12);
  EXPECT_LT(moved.position.y, 0);  // the model turns to the right, so the camera goes to the left
  EXPECT_GT(moved.position.z, 0);  // the model turns downwards, so the camera goes up
  expect_near(orbit(orbit(camera, 0.3, 0), -0.3, 0).position, camera.position);
  expect_near(orbit(camera, 2 * std::numbers::pi, 0).position, camera.position);
}

TEST(CameraControl, OrbitStopsShortOfThePoles) {
  for (const double pitch : {3.0, -3.0, 100.0, -100.0}) {
    const Camera moved = orbit(some_camera(), 0.1, pitch);
    EXPECT_GT(std::hypot(moved.position.x - 1, moved.position.y), 0.03);
    EXPECT_NEAR(distance(moved.position, moved.target), 3, 1e-12);
  }
}

TEST(CameraControl, ACameraAtThePoleMayLeaveIt) {
  const Camera above{{0, 0, 5}, {0, 0, 0}};
  EXPECT_EQ(orbit(above, 0, -1).position.z, 5);
  EXPECT_LT(orbit(above, 0, 1).position.z, 4);
}

TEST(CameraControl, LookTurnsOnTheSpot) {
  const Camera camera = some_camera(), moved = look_around(camera, 0.3, 0.2);
  EXPECT_EQ(moved.position, camera.position);
  EXPECT_NEAR(distance(moved.position, moved.target), 3, 1e-12);
  EXPECT_GT(moved.target.y, 0);  // to the right
  EXPECT_GT(moved.target.z, 0);  // upwards
}

TEST(CameraControl, PanMovesByPictureHeights) {
  const Camera camera = some_camera();
  const double height = 2 * 3 * std::tan(camera.vertical_fov / 2);
  expect_near(pan(camera, 0, 1).position, {4, 0, height});
  expect_near(pan(camera, 0, 1).target, {1, 0, height});
  expect_near(pan(camera, 0.5, 0).target, {1, height / 2, 0});
}

TEST(CameraControl, DollyAndTravel) {
  const Camera camera = some_camera();
  expect_near(dolly(camera, 0.5).position, {2.5, 0, 0});
  EXPECT_EQ(dolly(camera, 0.5).target, camera.target);
  EXPECT_EQ(dolly(camera, 0), camera);
  EXPECT_EQ(dolly(camera, -1), camera);
  expect_near(travel(camera, {0, 0, 2}).position, {2, 0, 0});
  expect_near(travel(camera, {0, 0, 2}).target, {-1, 0, 0});
}

TEST(CameraControl, FocusApproachesThePoint) {
  const Camera moved = focus(some_camera(), {0, 2, 0}, 0.25);
  expect_near(moved.target, {0, 2, 0});
  expect_near(moved.position, {1, 1.5, 0});
  EXPECT_EQ(focus(some_camera(), some_camera().position), some_camera());  // nowhere to look from
}

TEST(CameraControl, NarrowPicturesAreSeenFromFartherAway) {
  const Camera camera{{0, -4, 1}, {0, 0, 1}};
  EXPECT_EQ(fitted(camera, 1), camera);
  EXPECT_EQ(fitted(camera, 3), camera);
  for (const double aspect : {0.9, 0.5, 0.1}) {
    const Camera far = fitted(camera, aspect);
    // The sphere that touches the picture's sides subtends the same share of it.
    const double half_across = std::atan(aspect * std::tan(0.5 * camera.vertical_fov));
    EXPECT_NEAR(length(far.position - far.target) * std::sin(half_across), 4 * std::sin(0.5 * camera.vertical_fov),
                1e-9);
    EXPECT_EQ(far.target, camera.target);
  }
}

TEST(CameraControl, AxesAreSeenFromTheCamera) {
  const auto near = [](Vec3d a, Vec3d b) { return length(a - b) < 1e-12; };
  // From the front, z up: x to the right, y away from the eye.
  const auto [x, y, z] = axes_in_view({{0, -3, 0}, {0, 0, 0}});
  EXPECT_TRUE(near(x, {1, 0, 0}) && near(y, {0, 0, -1}) && near(z, {0, 1, 0}));
  const auto turned = axes_in_view(orbit({{1, -3, 2}, {0, 0, 0}}, 0.4, 0.2));
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) EXPECT_NEAR(dot(turned[a], turned[b]), a == b ? 1 : 0, 1e-12);
}

TEST(CameraControl, WhatIsNoCameraStays) {
  Camera broken = some_camera();
  broken.position.x = nan;
  EXPECT_FALSE(is_valid(broken));
  const Camera moved = orbit(broken, 1, 1);
  EXPECT_TRUE(std::isnan(moved.position.x));
  EXPECT_EQ(moved.target, broken.target);
  Camera blind = some_camera();
  blind.target = blind.position;
  EXPECT_FALSE(is_valid(blind));
  EXPECT_EQ(dolly(blind, 2), blind);
  Camera flat = some_camera();
  flat.up = {0, 0, 0};
  EXPECT_FALSE(is_valid(flat));
}

double hostile() {
  return *rc::gen::oneOf(rc::gen::arbitrary<double>(),
                         rc::gen::element(nan, infinity, -infinity, 0.0, -0.0, 1e308, 1e-308, 1e18, 1.0));
}

RC_GTEST_PROP(CameraControl, NoSequenceOfMovementsLeavesTheSane, ()) {
  Camera camera = some_camera();
  for (int i = 0; i < 20; ++i) {
    const double a = hostile(), b = hostile(), c = hostile();
    switch (*rc::gen::inRange(0, 7)) {
      case 0:
        camera = orbit(camera, a, b);
        break;
      case 1:
        camera = look_around(camera, a, b);
        break;
      case 2:
        camera = pan(camera, a, b);
        break;
      case 3:
        camera = dolly(camera, a);
        break;
      case 4:
        camera = travel(camera, {a, b, c});
        break;
      case 5:
        camera = focus(camera, {a, b, c}, 0.5);
        break;
      default:
        camera = between(camera, some_camera(), a);
        break;
    }
    RC_ASSERT(is_valid(camera));
  }
}

// ---- in time ----

TEST(CameraTrack, RecordsThirtyKeysASecond) {
  CameraRecorder recorder;
  EXPECT_TRUE(recorder.stop(1).empty());
  const Camera first = some_camera(), second = dolly(first, 2), third = dolly(first, 3);
  recorder.start(10, first);
  EXPECT_TRUE(recorder.recording());
  recorder.add(10.5, second);
  recorder.add(11, third);
  const std::vector<Camera> keys = recorder.stop(11.5);
  EXPECT_FALSE(recorder.recording());
  ASSERT_EQ(keys.size(), 47u);  // 46 ticks in one and a half seconds, and the last camera
  EXPECT_EQ(keys[0], first);
  EXPECT_EQ(keys[15], first);
  EXPECT_EQ(keys[16], second);
  EXPECT_EQ(keys[30], second);
  EXPECT_EQ(keys[31], third);
  EXPECT_EQ(keys.back(), third);
}

TEST(CameraTrack, ClocksThatGoBackwardsDoNoHarm) {
  CameraRecorder recorder;
  recorder.start(10, some_camera());
  recorder.add(5, some_camera());
  recorder.add(nan, some_camera());
  EXPECT_EQ(recorder.stop(9).size(), 2u);
}

TEST(CameraTrack, PlaysWhatWasRecordedInItsTime) {
  std::vector<Camera> keys;
  for (int i = 0; i <= 60; ++i) keys.push_back(dolly(some_camera(), 1 + i));
  CameraPlayer player;
  EXPECT_FALSE(player.advance(0));
  player.start(100, keys);
  EXPECT_EQ(player.advance(99), keys[0]);
  EXPECT_EQ(player.advance(100), keys[0]);
  expect_near(player.advance(101)->position, keys[30].position, 1e-9);
  expect_near(player.advance(100.05)->position, between(keys[1], keys[2], 0.5).position, 1e-9);
  EXPECT_TRUE(player.playing());
  EXPECT_EQ(player.advance(102.01), keys[60]);
  EXPECT_FALSE(player.playing());
}

TEST(CameraTrack, FewKeysTakeTheirTime) {
  CameraPlayer player;
  const Camera from = some_camera(), to = dolly(from, 3);
  player.start(0, {from, to});
  expect_near(player.advance(1)->position, dolly(from, 2).position, 1e-9);
  EXPECT_EQ(player.advance(2), to);
  player.start(0, {from});
  EXPECT_EQ(player.advance(0), from);
  EXPECT_FALSE(player.playing());
}

TEST(CameraTrack, TransitionsEndExactly) {
  CameraTransition transition;
  const Camera from = some_camera(), to = dolly(from, 3);
  EXPECT_FALSE(transition.advance(0));
  transition.start(1, from, to);
  EXPECT_EQ(transition.advance(1), from);
  const double way = distance(transition.advance(1.1)->position, from.position);
  EXPECT_GT(way, 0);
  EXPECT_LT(way, distance(to.position, from.position));
  EXPECT_EQ(transition.advance(1.3), to);
  EXPECT_FALSE(transition.moving());
  Camera broken = to;
  broken.target.x = nan;
  transition.start(2, from, broken);
  EXPECT_FALSE(transition.advance(2.1));
}

}  // namespace
}  // namespace lodestone::viewer
