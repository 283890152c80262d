// The heat map of stored errors: steps, colours, and the picture against the cell under each pixel.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "core/base/error.h"
#include "render/frame/shading.h"
#include "tests/render/viewer/two_tori.h"

namespace lodestone::viewer {
namespace {

TEST(ErrorMap, StepsHaveEqualRatios) {
  const HeatRange range{1e-4, 10};
  EXPECT_EQ(heat_step(0, range), 0);
  EXPECT_EQ(heat_step(range.least, range), 1);
  EXPECT_EQ(heat_step(range.most, range), heat_steps);
  for (int step = 1; step <= heat_steps; ++step) {
    EXPECT_EQ(heat_step(heat_of_step(step, range), range), step);
    if (step > 1) {
      EXPECT_NEAR(heat_of_step(step, range) / heat_of_step(step - 1, range), std::pow(1e5, 1.0 / 16), 1e-9);
    }
  }
  // One error alone, and none.
  EXPECT_EQ(heat_step(0.5, {0.5, 0.5}), 1);
  EXPECT_EQ(heat_step(std::nan(""), range), 0);
  EXPECT_EQ(heat_step(0.5, {}), 0);
  std::set<std::array<float, 3>> colours;
  for (int step = 0; step <= heat_steps; ++step) {
    const Vec3f c = heat_colour(step);
    for (const float channel : {c.x, c.y, c.z}) EXPECT_TRUE(channel >= 0 && channel <= 1);
    colours.insert({c.x, c.y, c.z});
  }
  EXPECT_EQ(colours.size(), heat_steps + 1u);  // no two alike
}

class ErrorMapDrawn : public test::TwoTori, public testing::WithParamInterface<const char*> {};

// The twin: unlit, each pixel has the colour of the cell under it.
TEST_P(ErrorMapDrawn, EveryPixelTellsTheErrorOfItsCell) {
  std::unique_ptr<Renderer> renderer;
  try {
    renderer = make_renderer(GetParam(), *scheduler_);
  } catch (const UnsupportedError& error) {
    GTEST_SKIP() << error.what();
  }
  drawing_.set_renderer(renderer.get());
  state_.looks.lighting.ambient = 1;
  state_.current().kappa0 = 2.5f;
  (void)drawing_.draw(state_, 0, size);
  const Image plain = renderer->read_back();
  apply(Action::toggle_errors, state_);
  EXPECT_TRUE(drawing_.draw(state_, 0, size));
  EXPECT_FALSE(drawing_.draw(state_, 0, size));
  const Image image = renderer->read_back();
  std::set<int> steps;
  int differing = 0;
  for (int y = 0; y < size.height; y += 3)
    for (int x = 0; x < size.width; x += 3) {
      const auto surface = drawing_.surface_at(0, size, x + 0.5, y + 0.5);
      if (!surface) continue;
      const double error = facts_of(*surface, drawing_.scene_view(), state_.camera).error;
      const int step = heat_step(error, drawing_.errors());
      steps.insert(step);
      const Vec3f expected = heat_colour(step);
      const std::uint8_t* rgb = &image.rgba[4 * static_cast<std::size_t>(y * size.width + x)];
      for (const auto& [seen, wanted] : {std::pair{rgb[0], expected.x}, {rgb[1], expected.y}, {rgb[2], expected.z}})
        if (std::abs(seen - shading::to_byte(wanted)) > 1) {
          ++differing;
          break;
        }
    }
  EXPECT_GT(steps.size(), 3u);
  EXPECT_LT(differing, 5);  // where cells meet
  // The same surface, and switched off the same picture.
  EXPECT_EQ(image.depth, plain.depth);
  apply(Action::toggle_errors, state_);
  EXPECT_TRUE(drawing_.draw(state_, 0, size));
  EXPECT_EQ(renderer->read_back().rgba, plain.rgba);
}

INSTANTIATE_TEST_SUITE_P(Backends, ErrorMapDrawn, testing::Values("soft", "gl"));

class ErrorParts : public test::TwoTori {};

TEST_F(ErrorParts, ErrorsReplaceTheTintOfLevels) {
  state_.current().tint = true;
  (void)draw();
  state_.current().errors = true;  // the same share of a tint: it is drawn all the same
  EXPECT_TRUE(drawing_.draw(state_, 0, size));
}

TEST_F(ErrorParts, ThePartsOfAMapArePartsOfTheSelection) {
  state_.looks.lighting.directional = {0.5f, true, 256};
  (void)draw();
  const Frame& own = drawing_.frame(0);
  ErrorMap map;
  const Frame& parts = map.of(own, drawing_.scene_view(), drawing_.errors());
  for (std::uint32_t m = 0; m < 2; ++m) {
    std::multiset<std::uint32_t> selected, drawn;
    for (const SelectedCell& cell : own.models[m].selection->cells) selected.insert(cell.cell);
    int casters = 0;
    for (const ModelFrame& part : parts.models) {
      if (part.view_projection.m != own.models[m].view_projection.m) continue;
      casters += part.casters != nullptr;
      for (const SelectedCell& cell : part.selection->cells) {
        drawn.insert(cell.cell);
        const double error = drawing_.scene_view().placement(m).scale *
                             double{drawing_.scene_view().hierarchy(m).cells[cell.cell].error};
        EXPECT_EQ(part.tint, heat_colour(heat_step(error, drawing_.errors())));
      }
    }
    EXPECT_EQ(drawn, selected);
    EXPECT_EQ(casters, 1);  // shadows are drawn once
  }
}

}  // namespace
}  // namespace lodestone::viewer
