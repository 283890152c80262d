// Actions in an open model: home, paths, flights, screenshots, messages, focus and measuring, without the window.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "render/camera/camera.h"
#include "render/viewer/controls/camera_control.h"
#include "tests/render/viewer/view_session_case.h"

namespace lodestone::viewer {
namespace {

namespace fs = std::filesystem;

TEST_F(Session, HomeFitsThePictures) {
  session_.open({lode_}, 0);
  ASSERT_TRUE(opened());
  ViewState& state = session_.state;
  const auto away = [&] { return length(state.camera.position - state.camera.target); };
  session_.fit_home({1280, 720}, 0);
  EXPECT_EQ(state.camera, state.home);
  apply(Action::toggle_split, state);
  session_.fit_home({1280, 720}, 0);  // two halves, narrower than high
  const double in_half = away();
  EXPECT_GT(in_half, length(state.home.position - state.home.target));
  apply(Action::toggle_split, state);
  session_.fit_home({1280, 720}, 0);
  EXPECT_EQ(state.camera, state.home);
  // A camera that has moved is its user's.
  const Camera moved = state.camera = orbit(state.camera, 0.3, 0);
  apply(Action::toggle_split, state);
  session_.fit_home({1280, 720}, 0);
  EXPECT_EQ(state.camera, moved);
  session_.act(Action::go_home, 1);
  session_.advance(9);
  EXPECT_EQ(away(), in_half);
}

TEST_F(Session, RecordedPathsAreWrittenAndPlayed) {
  session_.open({lode_}, 0);
  ASSERT_TRUE(opened());
  session_.act(Action::play, 0);
  EXPECT_NE(said_.back().find("nothing to play"), std::string::npos);
  session_.act(Action::record, 1);
  EXPECT_TRUE(session_.recording());
  session_.state.camera = orbit(session_.state.camera, 1, 0);
  session_.advance(1.5);
  session_.act(Action::record, 2);
  EXPECT_FALSE(session_.recording());
  const std::string file = (folder_ / "path001.json").string();
  EXPECT_EQ(session_.written(), std::vector{file});
  const std::vector<Camera> keys = read_camera_keys(file);
  EXPECT_EQ(keys.size(), 32u);

  session_.act(Action::go_home, 3);
  session_.advance(4);
  EXPECT_EQ(session_.state.camera, session_.state.home);
  session_.act(Action::play, 10);
  EXPECT_TRUE(session_.playing());
  EXPECT_TRUE(session_.animated());
  session_.advance(20);
  EXPECT_FALSE(session_.playing());
  EXPECT_LT(length(session_.state.camera.position - keys.back().position), 1e-9);
  session_.act(Action::record, 30);
  session_.act(Action::stop, 31);
  EXPECT_TRUE(fs::exists(folder_ / "path002.json"));
}

TEST_F(Session, DroppedPathsPlayAndBadOnesAreSaid) {
  session_.open({lode_}, 0);
  ASSERT_TRUE(opened());
  const Camera camera{{3, 3, 3}, {0, 0, 0}};
  const std::string path = (folder_ / "way.json").string();
  write_camera_path(path, std::vector{camera});
  session_.open({path}, 5);
  session_.advance(5);
  EXPECT_EQ(session_.state.camera.position, camera.position);
  std::ofstream(folder_ / "bad.json") << "{\"frames\": [{\"position\": [NaN, 0, 0]}]}";
  session_.open({folder_ / "bad.json"}, 6);
  EXPECT_NE(said_.back().find("bad.json"), std::string::npos);
  EXPECT_TRUE(session_.message(6)->error);
  EXPECT_EQ(session_.state.camera.position, camera.position);
}

TEST_F(Session, CamerasThatCannotBeDrawnAreTakenBack) {
  session_.open({lode_}, 0);
  ASSERT_TRUE(opened());
  const Camera good = session_.state.camera = orbit(session_.state.camera, 1, 0);
  session_.accept_camera();
  session_.state.camera.position.x = 1e300;
  session_.refuse("too far", 1);
  EXPECT_EQ(session_.state.camera, good);
  EXPECT_EQ(said_.back(), "too far");
  session_.refuse("still", 1);
  EXPECT_EQ(session_.state.camera, session_.state.home);
  EXPECT_TRUE(session_.drawing().ready());
}

TEST_F(Session, ScreenshotsHaveFreeNames) {
  Image image;
  image.size = {2, 1};
  image.rgba = {1, 2, 3, 255, 4, 5, 6, 255};
  session_.act(Action::screenshot, 0);
  EXPECT_TRUE(session_.take_screenshot_request());
  EXPECT_FALSE(session_.take_screenshot_request());
  std::ofstream(folder_ / "screenshot001.png") << "somebody's";
  session_.save_screenshot(image, 0);
  EXPECT_EQ(read_png((folder_ / "screenshot002.png").string()).rgba, image.rgba);
  EXPECT_EQ(fs::file_size(folder_ / "screenshot001.png"), 10u);
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  session_.save_screenshot(Image{}, 0);  // an empty picture, where no file can be written either
  fs::permissions(folder_, fs::perms::owner_all);
  EXPECT_TRUE(session_.message(0)->error);
}

TEST_F(Session, FlightBeginsWithoutALeap) {
  session_.open({lode_}, 0);
  ASSERT_TRUE(opened());
  session_.advance(0);
  session_.state.steering = Steering::fly;
  const Camera before = session_.state.camera;
  (void)session_.navigation.key(session_.state, {.key = 'W', .pressed = true});
  session_.advance(10);  // the window slept so long
  EXPECT_EQ(session_.state.camera, before);
  session_.advance(10.1);
  EXPECT_NEAR(length(session_.state.camera.position - before.position), 0.1 * session_.state.fly_speed, 1e-9);
}

TEST_F(Session, MessagesGo) {
  EXPECT_EQ(session_.message(0), nullptr);
  session_.tell("hello", false, 1);
  EXPECT_EQ(session_.message(2)->text, "hello");
  EXPECT_EQ(session_.message(60), nullptr);
}

TEST_F(Session, FocusFollowsTheSurface) {
  session_.open({lode_}, 0);
  ASSERT_TRUE(opened());
  const ImageSize window{322, 120};
  session_.state.panel = false;
  session_.state.split = true;
  session_.focus_at({1, 1}, window, 0);  // background
  EXPECT_FALSE(session_.animated());
  const ImageSize half{160, 120};
  const Image image = [&] {
    (void)session_.drawing().draw(session_.state, 1, half);
    return renderer_->read_back();
  }();
  std::vector<std::size_t> hits;
  for (std::size_t i = 0; i < image.depth.size(); ++i)
    if (image.depth[i] < 1) hits.push_back(i);
  const std::size_t hit = hits[hits.size() / 3];
  const Point at{162 + static_cast<double>(hit % 160) + 0.5, static_cast<double>(hit / 160) + 0.5};
  session_.focus_at(at, window, 0);
  EXPECT_TRUE(session_.animated());
  session_.advance(1);
  (void)session_.drawing().draw(session_.state, 1, half);
  const auto surface = session_.drawing().surface_at(1, half, 80.5, 60.5);
  ASSERT_TRUE(surface);
  EXPECT_LT(length(session_.drawing().in_scene(*surface) - session_.state.camera.target), 0.1);
}

TEST_F(Session, ClicksMeasure) {
  session_.open({lode_}, 0);
  ASSERT_TRUE(opened());
  ViewState& state = session_.state;
  state.panel = false;
  const ImageSize window{160, 120};
  (void)session_.drawing().draw(state, 0, window);
  const Image image = renderer_->read_back();
  std::vector<Point> on_surface;
  for (std::size_t i = 0; i < image.depth.size(); i += 41)
    if (image.depth[i] < 1)
      on_surface.push_back({static_cast<double>(i % 160) + 0.5, static_cast<double>(i / 160) + 0.5});
  const auto click = [&](Point at, double now) {
    session_.navigation.press(Button::left, at, now);
    session_.navigation.release(Button::left, at, now + 0.05);
    session_.use_clicks(window, now);
  };
  click(on_surface[0], 0);
  EXPECT_TRUE(state.measure.points.empty());  // not while it is off
  apply(Action::toggle_measure, state);
  click({1, 1}, 1);  // background
  EXPECT_TRUE(state.measure.points.empty());
  click(on_surface[0], 2);
  EXPECT_EQ(distance(state.measure), std::nullopt);
  click(on_surface[0], 2.1);  // a double click measures, too
  EXPECT_EQ(distance(state.measure), 0);
  EXPECT_FALSE(session_.animated());
  click(on_surface.front(), 3);
  click(on_surface.back(), 4);
  const auto at = [&](Point p) {
    return session_.drawing().in_scene(*session_.drawing().surface_at(0, window, p.x, p.y));
  };
  EXPECT_EQ(distance(state.measure), length(at(on_surface.back()) - at(on_surface.front())));
  EXPECT_GT(*distance(state.measure), 0.1);
}

}  // namespace
}  // namespace lodestone::viewer
