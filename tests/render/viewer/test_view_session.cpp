// Files that open in the background, paths, screenshots, messages: the viewer without its window.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/hierarchy/lode/lode_file.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"
#include "render/viewer/controls/camera_control.h"
#include "render/viewer/session/view_session.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_folder.h"
#include "tests/test_meshes.h"

namespace lodestone::viewer {
namespace {

namespace fs = std::filesystem;

class Session : public FolderTest {
 protected:
  Session() {
    hierarchy_ = test::naive_hierarchy(test::torus_mesh(96, 48), 3).hierarchy;
    (void)write_lode(hierarchy_, lode_);
    std::ofstream mesh(mesh_);
    mesh << "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
    session_.drawing().set_renderer(renderer_.get());
  }

  SessionConfig config() {
    SessionConfig config;
    config.load.threads = 2;
    config.folder = folder_;
    config.wake = [this] { ++wakes_; };
    config.say = [this](const std::string& line) { said_.push_back(line); };
    return config;
  }
  // Waits as the window's loop does.
  bool opened() {
    while (session_.loader() && !session_.loader()->ended()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return session_.collect(0);
  }

  std::string lode_ = (folder_ / "torus.lode").string(), mesh_ = (folder_ / "tetrahedron.off").string();
  Hierarchy hierarchy_;
  std::atomic<int> wakes_{0};
  std::vector<std::string> said_;
  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
  std::unique_ptr<Renderer> renderer_ = make_renderer("soft", *scheduler_);
  ViewSession session_{config(), *scheduler_};
};

TEST_F(Session, OpensHierarchiesAndMeshes) {
  EXPECT_FALSE(session_.collect(0));
  session_.open({lode_}, 0);
  ASSERT_TRUE(opened());
  EXPECT_EQ(session_.drawing().model()->name, "torus.lode");
  EXPECT_EQ(session_.drawing().model()->opened.models().front().hierarchy->cells.size(), hierarchy_.cells.size());
  EXPECT_EQ(session_.state.camera, session_.state.home);
  EXPECT_GT(wakes_, 0);
  session_.open({mesh_}, 0);
  ASSERT_TRUE(opened());
  EXPECT_EQ(session_.drawing().model()->opened.models().front().hierarchy->provenance.input_triangles, 4u);
  EXPECT_EQ(session_.drawing().counts().uploads, 2u);
  EXPECT_FALSE(session_.collect(0));
}

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

TEST_F(Session, LargeFilesStream) {
  SessionConfig small = config();
  small.load.memory_budget = 100'000;
  ViewSession session(small, *scheduler_);
  session.drawing().set_renderer(renderer_.get());
  session.open({lode_}, 0);
  while (!session.loader()->ended()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ASSERT_TRUE(session.collect(0));
  ViewDrawing& drawing = session.drawing();
  ASSERT_TRUE(drawing.model()->opened.streamed());
  EXPECT_LE(drawing.model()->opened.resident_bytes(), 100'000u);
  // Frames while it loads: never a cell without its arrays, never more than allowed.
  session.state.settings[0].pixel_error = 4;
  for (int frame = 0; frame < 300; ++frame) {
    const ImageSize size{160, 120};
    if (frame == 100) session.act(Action::toggle_frozen, 0);
    if (frame == 150) session.act(Action::toggle_frozen, 0);
    session.state.camera = orbit(session.state.camera, 0.02, 0);
    const std::vector<ViewDrawing::View> views{{0, size, size}, {1, size, size}};
    for (const ViewDrawing::View& view : views) {
      if (frame >= 95 && frame < 110 && view.settings == 1) continue;  // not shown when the selection is frozen
      (void)drawing.draw(session.state, view, views);
      for (const SelectedCell& s : drawing.frame(view.settings).only().selection->cells)
        ASSERT_FALSE(drawing.model()->opened.models().front().hierarchy->cells[s.cell].positions.empty()) << frame;
    }
    ASSERT_LE(drawing.model()->opened.resident_bytes(), 100'000u);
  }
}

// A budget for a part of what two views of a camera at rest need: they come to rest, and nothing is drawn any more.
class SessionAtRest : public Session, public testing::WithParamInterface<const char*> {};

TEST_P(SessionAtRest, DrawsNothingAgain) {
  std::unique_ptr<Renderer> renderer;
  try {
    renderer = make_renderer(GetParam(), *scheduler_);
  } catch (const UnsupportedError& error) {
    GTEST_SKIP() << error.what();
  }
  SessionConfig small = config();
  small.load.memory_budget = 100'000;
  ViewSession session(small, *scheduler_);
  session.drawing().set_renderer(renderer.get());
  session.open({lode_}, 0);
  while (!session.loader()->ended()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ASSERT_TRUE(session.collect(0));
  ViewDrawing& drawing = session.drawing();
  session.state.settings[0].pixel_error = 0.2f;
  session.state.settings[1].pixel_error = 0.3f;
  const ImageSize size{160, 120};
  const std::vector<ViewDrawing::View> views{{0, size, size}, {1, size, size}};
  const OpenScene& opened = drawing.model()->opened;
  int last = 0;
  for (int frame = 1; (frame < last + 100 || opened.resident_bytes() < 90'000) && frame < 5000; ++frame) {
    for (const ViewDrawing::View& view : views)
      if (drawing.draw(session.state, view, views)) last = frame;
    std::this_thread::sleep_for(std::chrono::microseconds(100));  // for the loader
  }
  EXPECT_GT(last, 10);
  EXPECT_LT(last, 4900);
  EXPECT_FALSE(opened.complete());
  const DetailLimits limits = opened.models().front().resident->limits();
  EXPECT_GT(limits.size(), 0u);
  for (const ViewDrawing::View& view : views)
    EXPECT_TRUE(std::ranges::equal(drawing.frame(view.settings).only().morph.limits, limits));
}

INSTANTIATE_TEST_SUITE_P(Backends, SessionAtRest, testing::Values("soft", "gl"));

TEST_F(Session, ScenesBringTheirModelsLooksAndCamera) {
  std::ofstream(folder_ / "two.toml") << R"(
[detail]
blend = "cosine"
pixel_error = 3
[camera]
key = [{position = [9, 0, 1], target = [0, 0, 0]}, {position = [0, 9, 1], target = [0, 0, 0]}]
[[model]]
file = "torus.lode"
[[model]]
file = "tetrahedron.off"
position = [3, 0, 0]
)";
  session_.open({folder_ / "two.toml"}, 0);
  ASSERT_TRUE(opened());
  EXPECT_EQ(session_.drawing().model()->opened.models().size(), 2u);
  EXPECT_EQ(session_.state.camera.position, (Vec3d{9, 0, 1}));
  EXPECT_EQ(session_.state.current().pixel_error, 3);
  EXPECT_EQ(session_.state.current().blend, Blend::cosine);
  EXPECT_TRUE(session_.has_path());
  EXPECT_TRUE(session_.drawing().draw(session_.state, 0, {160, 120}));
  EXPECT_EQ(session_.drawing().report(0).stats.cells, session_.drawing().report(0).selected);
  Image image = renderer_->read_back();
  session_.drawing().tint_band(0, image);
  EXPECT_FALSE(session_.drawing().box_lines(0, {160, 120}).empty());
}

TEST_F(Session, SeveralFilesAreShownTogether) {
  session_.open({lode_, mesh_, lode_}, 0);
  ASSERT_TRUE(opened());
  const Model& model = *session_.drawing().model();
  EXPECT_EQ(model.name, "torus.lode and 2 more");
  ASSERT_EQ(model.opened.models().size(), 3u);
  EXPECT_EQ(model.opened.models()[0].hierarchy, model.opened.models()[2].hierarchy);  // named twice, opened once
}

TEST_F(Session, WhatCannotBeOpenedIsSaidOnce) {
  session_.open({folder_ / "missing.ply"}, 0);
  EXPECT_THROW((void)opened(), FileError);
  EXPECT_FALSE(session_.collect(0));
  EXPECT_EQ(session_.loader(), nullptr);
  std::ofstream(folder_ / "broken.lode") << "nothing";
  session_.open({folder_ / "broken.lode"}, 0);
  EXPECT_THROW((void)opened(), InputError);
  session_.open({lode_}, 0);
  EXPECT_TRUE(opened());
}

TEST_F(Session, OpeningCanBeCancelledAndReplaced) {
  session_.open({lode_}, 0);
  session_.act(Action::stop, 0);
  EXPECT_THROW((void)opened(), Cancelled);
  session_.open({lode_}, 0);
  session_.open({mesh_}, 0);
  ASSERT_TRUE(opened());
  EXPECT_EQ(session_.drawing().model()->name, "tetrahedron.off");
  session_.open({lode_}, 0);  // ends with the session
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

TEST_F(Session, ModelsThatCannotBeDrawnAreGivenUp) {
  session_.open({lode_}, 0);
  ASSERT_TRUE(opened());
  session_.refuse("altered", 1);
  EXPECT_FALSE(session_.drawing().ready());
  EXPECT_TRUE(session_.message(1)->error);
  session_.open({lode_}, 2);
  EXPECT_TRUE(opened());
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

TEST_F(Session, MissingTexturesAreSaid) {
  std::ofstream(folder_ / "bare.mtl") << "newmtl skin\nmap_Kd nowhere.png\n";
  std::ofstream(folder_ / "bare.obj") << "mtllib bare.mtl\nusemtl skin\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                         "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
  session_.open({folder_ / "bare.obj"}, 0);
  ASSERT_TRUE(opened());
  ASSERT_FALSE(said_.empty());
  EXPECT_NE(said_.back().find("nowhere.png"), std::string::npos) << said_.back();
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
