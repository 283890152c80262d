// Files that open in the background, stream, come together in scenes or are refused: the viewer without its window.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "core/base/error.h"
#include "render/camera/camera.h"
#include "render/viewer/controls/camera_control.h"
#include "tests/render/viewer/view_session_case.h"

namespace lodestone::viewer {
namespace {

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

TEST_F(Session, LargeFilesStream) {
  SessionConfig small = config();
  small.load.memory_budget = 100'000;
  ViewSession session(small, *scheduler_);
  session.drawing().set_renderer(renderer_.get());
  session.open({lode_}, 0);
  ASSERT_TRUE(opened(session));
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
  ASSERT_TRUE(opened(session));
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

TEST_F(Session, ModelsThatCannotBeDrawnAreGivenUp) {
  session_.open({lode_}, 0);
  ASSERT_TRUE(opened());
  session_.refuse("altered", 1);
  EXPECT_FALSE(session_.drawing().ready());
  EXPECT_TRUE(session_.message(1)->error);
  session_.open({lode_}, 2);
  EXPECT_TRUE(opened());
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

}  // namespace
}  // namespace lodestone::viewer
