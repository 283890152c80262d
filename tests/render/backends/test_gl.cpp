// Pictures, sizes and counts of the gl backend, and the models it is given.
#include <string>

#include "render/camera/camera.h"
#include "render/frame/shading.h"
#include "tests/expect_error.h"
#include "tests/render/backends/gl_fixture.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

std::array<std::uint8_t, 4> pixel(const Image& image, int x, int y) {
  const std::size_t at =
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.size.width) + static_cast<std::size_t>(x));
  return {image.rgba[at], image.rgba[at + 1], image.rgba[at + 2], image.rgba[at + 3]};
}

float depth(const Image& image, int x, int y) {
  return image
      .depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.size.width) + static_cast<std::size_t>(x)];
}

// Window position of a point: pixel coordinates from the top left corner, depth in [0, 1].
Vec3d window_of(const Frame& frame, Vec3d p) {
  const auto& m = frame.only().view_projection.m;
  const auto row = [&](std::size_t i) {
    return m[4 * i] * p.x + m[4 * i + 1] * p.y + m[4 * i + 2] * p.z + m[4 * i + 3];
  };
  return {(1 + row(0) / row(3)) / 2 * frame.size.width, (1 - row(1) / row(3)) / 2 * frame.size.height,
          (1 + row(2) / row(3)) / 2};
}

TEST_F(GlTest, PlateHasTheColourDepthAndPlaceThatTheFormulasSay) {
  const NaiveHierarchy plate_above = naive_hierarchy(plate(16), 1);
  WholeFrame whole(plate_above.hierarchy, with_kappa0(2), from_above);
  whole.frame.only().towards_eye = {0.6f, 0, 0.8f};
  renderer_->upload(plate_above.hierarchy);
  const FrameStats stats = renderer_->draw(whole.frame);
  const Image image = renderer_->read_back();
  ASSERT_EQ(image.size, whole.frame.size);
  ASSERT_EQ(image.rgba.size(), 4u * 160 * 120);
  ASSERT_EQ(image.depth.size(), 1u * 160 * 120);

  // The corners of the plate bound a rectangle of pixels: inside the shading formula, outside the background.
  const Vec3d left_bottom = window_of(whole.frame, {0, 0, 0.5}), right_top = window_of(whole.frame, {1, 0.5, 0.5});
  const float shade = 0.2f + 0.8f * 0.8f;
  const Vec3f expected = shade * Appearance{}.base_colour;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const bool covered =
          x + 0.5 > left_bottom.x && x + 0.5 < right_top.x && y + 0.5 > right_top.y && y + 0.5 < left_bottom.y;
      if (covered) {
        ASSERT_NEAR(pixel(image, x, y)[0], shading::to_byte(expected.x), 1) << x << " " << y;
        ASSERT_NEAR(pixel(image, x, y)[1], shading::to_byte(expected.y), 1);
        ASSERT_NEAR(pixel(image, x, y)[2], shading::to_byte(expected.z), 1);
        ASSERT_EQ(pixel(image, x, y)[3], 255);
        ASSERT_NEAR(depth(image, x, y), left_bottom.z, 1e-6);
      } else {
        ASSERT_EQ(pixel(image, x, y), shading::background_bytes) << x << " " << y;
        ASSERT_EQ(depth(image, x, y), 1);
      }
    }
  // Rows from the top: the plate lies above the middle.
  EXPECT_LT(right_top.y, 30);
  EXPECT_NEAR(left_bottom.y, 60, 1e-3);

  EXPECT_EQ(stats.cells, whole.selection.cells.size());
  EXPECT_EQ(stats.triangles, 2u * 16 * 16);
  EXPECT_EQ(stats.draw_calls, 1u);
  for (const char* stage : {"upload", "gpu", "total"}) {
    ASSERT_EQ(stats.milliseconds.count(stage), 1u) << stage;
    EXPECT_GE(stats.milliseconds.at(stage), 0) << stage;
  }
  EXPECT_LE(stats.milliseconds.at("upload"), stats.milliseconds.at("total"));
  EXPECT_LE(stats.milliseconds.at("gpu"), stats.milliseconds.at("total"));
}

TEST_F(GlTest, BothSidesAreLit) {
  const NaiveHierarchy plate_above = naive_hierarchy(plate(4), 0);
  const Camera from_below{{0.5, 0.25, -0.5}, {0.5, 0.25, 0.5}, {0, 1, 0}};
  WholeFrame whole(plate_above.hierarchy, with_kappa0(2), from_below);
  whole.frame.only().towards_eye = {0, 0, -1};
  renderer_->upload(plate_above.hierarchy);
  (void)renderer_->draw(whole.frame);
  EXPECT_NEAR(pixel(renderer_->read_back(), 80, 60)[0], shading::to_byte(Appearance{}.base_colour.x), 1);
}

TEST_F(GlTest, TintFollowsTheLevel) {
  const NaiveHierarchy plate_above = naive_hierarchy(plate(16), 2);
  renderer_->upload(plate_above.hierarchy);
  for (const auto& [kappa0, level] : {std::pair{100.0f, 2}, std::pair{0.01f, 0}}) {
    WholeFrame whole(plate_above.hierarchy, with_kappa0(kappa0), from_above);
    if (level == 0) whole.selection.cells = {{.cell = CellId(0), .visible = true, .morphing = false}};
    ASSERT_EQ(whole.selection.cells.front().level, level);
    whole.frame.settings.level_tint = 1;
    whole.frame.only().effects.set(Effect::level_tint, true);
    (void)renderer_->draw(whole.frame);
    EXPECT_NEAR(pixel(renderer_->read_back(), 80, 40)[1], shading::to_byte(shading::tint_of(level).y), 1);
  }
}

TEST_F(GlTest, CulledCellsAreNeitherDrawnNorCounted) {
  const NaiveHierarchy plate_above = naive_hierarchy(plate(16), 1);
  WholeFrame whole(plate_above.hierarchy, with_kappa0(100), from_above);
  std::uint64_t left = 0;
  for (SelectedCell& selected : whole.selection.cells) {
    const Cell& cell = plate_above.hierarchy.cells[selected.cell];
    selected.visible = cell.code.coord().x == 0;
    if (selected.visible) left += cell.triangles.size();
  }
  renderer_->upload(plate_above.hierarchy);
  const FrameStats stats = renderer_->draw(whole.frame);
  const Image image = renderer_->read_back();
  EXPECT_EQ(stats.triangles, left);
  EXPECT_LT(stats.cells, whole.selection.cells.size());
  EXPECT_NE(pixel(image, 60, 40), shading::background_bytes);
  EXPECT_EQ(pixel(image, 100, 40), shading::background_bytes);
}

TEST_F(GlTest, AnEmptySelectionGivesTheBackground) {
  const NaiveHierarchy plate_above = naive_hierarchy(plate(4), 0);
  WholeFrame whole(plate_above.hierarchy, with_kappa0(2), from_above);
  whole.selection.cells.clear();
  renderer_->upload(plate_above.hierarchy);
  const FrameStats stats = renderer_->draw(whole.frame);
  EXPECT_EQ(stats.cells, 0u);
  EXPECT_EQ(stats.triangles, 0u);
  EXPECT_EQ(pixel(renderer_->read_back(), 80, 40), shading::background_bytes);
  EXPECT_TRUE(renderer_->capture(whole.frame).empty());
}

TEST_F(GlTest, SizesMayChangeFromFrameToFrame) {
  const NaiveHierarchy plate_above = naive_hierarchy(plate(8), 1);
  renderer_->upload(plate_above.hierarchy);
  EXPECT_TRUE(renderer_->read_back().rgba.empty());  // no frame yet
  const auto draw = [&](ImageSize size) {
    WholeFrame whole(plate_above.hierarchy, with_kappa0(2), from_above, Blend::linear, size);
    (void)renderer_->draw(whole.frame);
    return renderer_->read_back();
  };
  const Image small = draw({64, 48}), large = draw({333, 77}), again = draw({64, 48});
  EXPECT_EQ(large.size, (ImageSize{333, 77}));
  EXPECT_EQ(large.depth.size(), 333u * 77);
  EXPECT_EQ(small.rgba, again.rgba);
  EXPECT_EQ(small.depth, again.depth);
}

TEST_F(GlTest, RenderersDoNotDisturbEachOther) {
  const NaiveHierarchy low = naive_hierarchy(plate(8), 1), high = naive_hierarchy(plate(8, 0.5f), 1);
  auto other = make_gl_renderer();
  EXPECT_EQ(other->name(), "gl");
  EXPECT_FALSE(other->device().empty());
  renderer_->upload(low.hierarchy);
  other->upload(high.hierarchy);
  WholeFrame low_frame(low.hierarchy, with_kappa0(2), from_above);
  WholeFrame high_frame(high.hierarchy, with_kappa0(2), from_above);
  (void)renderer_->draw(low_frame.frame);
  const Image before = renderer_->read_back();
  (void)other->draw(high_frame.frame);
  EXPECT_EQ(renderer_->read_back().rgba, before.rgba);
  EXPECT_NE(other->read_back().rgba, before.rgba);
  other.reset();
  (void)renderer_->draw(low_frame.frame);
  EXPECT_EQ(renderer_->read_back().rgba, before.rgba);
}

TEST_F(GlTest, ANewUploadReplacesTheModel) {
  const NaiveHierarchy low = naive_hierarchy(plate(8), 1), high = naive_hierarchy(plate(8, 0.5f), 2);
  WholeFrame low_frame(low.hierarchy, with_kappa0(2), from_above);
  WholeFrame high_frame(high.hierarchy, with_kappa0(2), from_above);
  renderer_->upload(high.hierarchy);
  (void)renderer_->draw(high_frame.frame);
  const Image reference = renderer_->read_back();
  renderer_->upload(low.hierarchy);
  (void)renderer_->draw(low_frame.frame);
  EXPECT_NE(renderer_->read_back().rgba, reference.rgba);
  renderer_->upload(high.hierarchy);
  (void)renderer_->draw(high_frame.frame);
  EXPECT_EQ(renderer_->read_back().rgba, reference.rgba);
}

TEST_F(GlTest, CellsBeyondAStorageBlockAreRefused) {
  const NaiveHierarchy low = naive_hierarchy(plate(8), 1);
  const auto renderer = make_gl_renderer({.max_storage_block_bytes = 64});
  expect_error_of<ResourceError>([&] { renderer->upload(low.hierarchy); }, {"smaller cells"});
}

}  // namespace
}  // namespace lodestone
