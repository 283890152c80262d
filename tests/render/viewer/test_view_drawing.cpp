// Selections, frozen ones, picking, lines and bands of the viewer, drawn by soft without a window.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/hierarchy/model/distance_metric.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"
#include "render/frame/shading.h"
#include "render/viewer/controls/camera_control.h"
#include "render/viewer/session/band_tint.h"
#include "render/viewer/session/view_drawing.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone::viewer {
namespace {

constexpr ImageSize size{160, 120};

// A hierarchy alone, as a file of it would be opened.
std::unique_ptr<Model> make_model(const std::string& name, Hierarchy hierarchy) {
  auto model = std::make_unique<Model>();
  model->name = name;
  model->scene = scene_of(name);
  model->opened = OpenScene(std::move(hierarchy));
  return model;
}

class Drawing : public testing::Test {
 protected:
  Drawing() {
    drawing_.set_renderer(renderer_.get());
    drawing_.set_model(model_.get());
    look_at(state_, drawing_.bounding_sphere(), orbit_path(hierarchy(), 1).front());
    state_.current().by_kappa0 = true;
    state_.current().kappa0 = 1;
  }
  const Hierarchy& hierarchy() const { return *model_->opened.models().front().hierarchy; }
  Image draw(std::size_t settings = 0) {
    (void)drawing_.draw(state_, settings, size);
    return renderer_->read_back();
  }
  const ModelFrame& shown(std::size_t settings = 0) const { return drawing_.frame(settings).only(); }
  std::vector<std::uint32_t> cells(std::size_t settings = 0) const {
    std::vector<std::uint32_t> list;
    for (const SelectedCell& s : shown(settings).selection->cells) list.push_back(s.cell);
    return list;
  }

  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
  std::unique_ptr<Renderer> renderer_ = make_renderer("soft", *scheduler_);
  std::unique_ptr<Model> model_ = make_model("torus", test::naive_hierarchy(test::torus_mesh(96, 48), 3).hierarchy);
  ViewDrawing drawing_{*scheduler_};
  ViewState state_;
};

TEST_F(Drawing, OnlyWhatChangesThePictureIsDrawn) {
  EXPECT_TRUE(drawing_.draw(state_, 0, size));
  EXPECT_FALSE(drawing_.draw(state_, 0, size));
  state_.panel = false;
  state_.settings[0].boxes = true;  // lines over the picture
  state_.settings[1].tint = true;
  EXPECT_FALSE(drawing_.draw(state_, 0, size));
  EXPECT_EQ(drawing_.counts().draws, 1u);
  EXPECT_EQ(drawing_.counts().selections, 1u);
  state_.camera = orbit(state_.camera, 0.1, 0);
  EXPECT_TRUE(drawing_.draw(state_, 0, size));
  for (const Action action : {Action::toggle_tint, Action::toggle_band, Action::coarser, Action::toggle_frozen}) {
    apply(action, state_);
    EXPECT_TRUE(drawing_.draw(state_, 0, size)) << static_cast<int>(action);
    EXPECT_FALSE(drawing_.draw(state_, 0, size)) << static_cast<int>(action);
  }
  EXPECT_TRUE(drawing_.draw(state_, 0, {80, 60}));
  drawing_.set_model(model_.get());
  EXPECT_TRUE(drawing_.draw(state_, 0, {80, 60}));
}

TEST_F(Drawing, AFrozenSelectionStays) {
  const Image before = draw();
  const std::vector<std::uint32_t> selected = cells();
  apply(Action::toggle_frozen, state_);
  EXPECT_EQ(draw().rgba, before.rgba);
  EXPECT_EQ(cells(), selected);
  state_.camera = dolly(orbit(state_.camera, 1, 0.2), 0.5);
  state_.current().kappa0 = 6;
  EXPECT_NE(draw().rgba, before.rgba);
  EXPECT_EQ(cells(), selected);
  EXPECT_GE(drawing_.frozen_lines(0, size).size(), 8u);  // a corner may lie behind the camera
  apply(Action::toggle_frozen, state_);
  (void)draw();
  EXPECT_NE(cells(), selected);
  EXPECT_TRUE(drawing_.frozen_lines(0, size).empty());
}

TEST_F(Drawing, SettingsAreFrozenEachWithItsOwn) {
  state_.settings[1] = state_.settings[0];
  state_.settings[1].kappa0 = 4;
  (void)draw(0);
  (void)draw(1);
  const std::size_t coarse = cells(0).size(), fine = cells(1).size();
  EXPECT_LT(coarse, fine);
  apply(Action::toggle_frozen, state_);
  state_.camera = dolly(state_.camera, 4);
  (void)draw(0);
  (void)draw(1);
  EXPECT_EQ(cells(0).size(), coarse);
  EXPECT_EQ(cells(1).size(), fine);
}

TEST_F(Drawing, CamerasThatCannotBeDrawnChangeNothing) {
  const Image before = draw();
  const std::vector<std::uint32_t> selected = cells();
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), 1e300}) {
    ViewState state = state_;
    state.camera.position.x = wrong;
    EXPECT_THROW((void)drawing_.draw(state, 0, size), InputError);
    EXPECT_EQ(renderer_->read_back().rgba, before.rgba);
    EXPECT_EQ(cells(), selected);
  }
}

TEST_F(Drawing, BoxesOfTheDrawnCellsAreInThePicture) {
  (void)draw();
  const std::vector<Line> lines = drawing_.box_lines(0, size);
  EXPECT_EQ(lines.size(), 12 * cells().size());  // the whole model is before the camera
  float nearest = 0;
  for (const Line& line : lines) {
    EXPECT_GT(line.nearness, 0);
    nearest = std::max(nearest, line.nearness);
    for (const float v : {line.x0, line.y0, line.x1, line.y1}) EXPECT_LT(std::abs(v), 1000);
  }
  EXPECT_EQ(nearest, 1);
}

TEST_F(Drawing, BoxesHaveTheColoursOfTheirRadiiOrLevels) {
  for (const RadiiRule rule : {RadiiRule::adaptive, RadiiRule::per_level}) {
    state_.current().rule = rule, state_.current().by_kappa0 = false;
    (void)draw();
    const std::vector<Line> lines = drawing_.box_lines(0, size);
    const ModelFrame& model = drawing_.frame(0).models.front();
    const HeatRange range = drawing_.radii(0);
    EXPECT_EQ(range.most > 0, rule == RadiiRule::adaptive);
    std::size_t k = 0;
    for (const SelectedCell& cell : model.selection->cells) {
      const double scale = drawing_.scene_view().placement(0).scale;
      const Vec3f expected = rule == RadiiRule::adaptive
                                 ? heat_colour(heat_step(scale * model.morph.radii->by_cell[cell.cell], range))
                                 : shading::tint_of(cell.level);
      for (int edge = 0; edge < 12; ++edge) EXPECT_EQ(lines.at(k++).colour, expected);
    }
    EXPECT_EQ(lines.size(), k);
  }
}

TEST_F(Drawing, LinesBehindTheCameraAreCut) {
  state_.camera = {{0.1, 0.1, 0.1}, {1, 0.2, 0.1}};
  (void)draw();
  const ViewProjection vp = view_projection(state_.camera, hierarchy(), size);
  std::vector<Line> lines;
  const Vec3f eye = viewpoint(state_.camera, hierarchy().transform);
  const Vec3f h{0.5f, 0.5f, 0.5f};
  project_box(vp, size, {eye - h, eye + h}, Vec3f{1, 1, 1}, lines);
  EXPECT_LT(lines.size(), 12u);
  EXPECT_GT(lines.size(), 0u);
  for (const Line& line : lines)
    for (const float v : {line.x0, line.y0, line.x1, line.y1}) EXPECT_TRUE(std::isfinite(v));
}

// The twin: lambda of every vertex as the cell has it that draws it.
TEST_F(Drawing, TheBandTellsLambdaByDistanceAlone) {
  int inside = 0;
  for (const auto metric : {DistanceMetric::euclidean, DistanceMetric::chebyshev})
    for (const float kappa0 : {1.0f, 2.5f, 6.0f})
      for (const double factor : {0.4, 1.0, 3.0}) {
        state_.metric = metric;
        state_.current().kappa0 = kappa0;
        const Camera camera = dolly(state_.home, factor);
        const Radii radii =
            make_radii(hierarchy(), for_picture(radii_config(state_.current(), metric), size, camera.vertical_fov));
        const MorphContext morph{&hierarchy(), &radii, Blend::smoothstep, viewpoint(camera, hierarchy().transform)};
        Selection all;
        select_cells(hierarchy(), radii, morph.viewpoint, {}, all);
        for (const SelectedCell& selected : all.cells)
          for (const Vec3f w : hierarchy().cells[selected.cell].positions) {
            const float lambda = morph_lambda(morph, selected.level, w);
            const std::optional<float> told = band_lambda(morph, w);
            if (lambda > 0 && lambda < 1) {
              ASSERT_TRUE(told);
              EXPECT_NEAR(*told, lambda, 1e-5);
              ++inside;
            } else if (told) {
              EXPECT_TRUE(*told < 1e-3f || *told > 1 - 1e-3f);
            }
          }
      }
  EXPECT_GT(inside, 1000);
}

// With a radius for every cell: the lambda of a drawn cell whose box holds the point.
TEST_F(Drawing, TheBandTellsLambdaOfTheCellByAdaptiveRadii) {
  int inside = 0;
  state_.current().rule = RadiiRule::adaptive;
  state_.current().by_kappa0 = false;
  for (const float pixels : {1.0f, 5.0f, 30.0f}) {
    state_.current().pixel_error = pixels;
    const auto metric = DistanceMetric::euclidean;
    const Camera camera = dolly(state_.home, 0.4);
    const Radii radii =
        make_radii(hierarchy(), for_picture(radii_config(state_.current(), metric), size, camera.vertical_fov));
    ASSERT_FALSE(radii.by_cell.empty());
    const MorphContext morph{&hierarchy(), &radii, Blend::smoothstep, viewpoint(camera, hierarchy().transform)};
    Selection all;
    select_cells(hierarchy(), radii, morph.viewpoint, {}, all);
    for (const SelectedCell& selected : all.cells)
      for (const Vec3f w : hierarchy().cells[selected.cell].positions) {
        const std::optional<float> told = band_lambda(morph, w);
        if (!told) continue;
        ++inside;
        EXPECT_TRUE(std::ranges::any_of(all.cells, [&](const SelectedCell& drawn) {
          const Box3f& box = hierarchy().cells[drawn.cell].bounds;
          return distance(metric, w, box) == 0 && vertex_lambda(morph, drawn.cell, VertexId(0)) == *told;
        }));
      }
  }
  EXPECT_GT(inside, 100);
}

TEST_F(Drawing, TheBandTintKeepsWhatStandsStill) {
  const Image plain = draw();
  Image tinted = plain;
  drawing_.tint_band(0, tinted);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < plain.depth.size(); ++i) {
    const bool same = std::equal(&plain.rgba[4 * i], &plain.rgba[4 * i] + 4, &tinted.rgba[4 * i]);
    EXPECT_TRUE(same || plain.depth[i] < 1);
    changed += same ? 0 : 1;
  }
  EXPECT_GT(changed, 100u);
  EXPECT_EQ(tinted.depth, plain.depth);
  const auto parallel = make_tbb_scheduler(4);
  Image again = plain;
  tint_band(again, drawing_.frame(0), *parallel);
  EXPECT_EQ(again.rgba, tinted.rgba);
}

TEST_F(Drawing, CountsTellTheWork) {
  EXPECT_EQ(drawing_.counts().uploads, 1u);
  for (int i = 0; i < 3; ++i) (void)draw();
  EXPECT_EQ(drawing_.counts().draws, 1u);
  EXPECT_EQ(drawing_.counts().selections, 1u);
  apply(Action::toggle_frozen, state_);
  for (int i = 0; i < 3; ++i) {
    state_.camera = orbit(state_.camera, 0.1, 0);
    (void)draw();
  }
  EXPECT_EQ(drawing_.counts().draws, 4u);
  EXPECT_EQ(drawing_.counts().selections, 1u);
  const auto other = make_renderer("null", *scheduler_);
  drawing_.set_renderer(other.get());
  EXPECT_EQ(drawing_.counts().uploads, 2u);
  drawing_.set_renderer(nullptr);
  EXPECT_FALSE(drawing_.ready());
}

TEST_F(Drawing, ModelsWithoutCellsLeaveNone) {
  const auto empty = make_model("empty", Hierarchy{});
  EXPECT_THROW(drawing_.set_model(empty.get()), InputError);
  EXPECT_FALSE(drawing_.ready());
  drawing_.set_model(model_.get());
  EXPECT_TRUE(drawing_.draw(state_, 0, size));
}

}  // namespace
}  // namespace lodestone::viewer
