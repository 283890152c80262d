// The surface under the pointer: against the depth of the picture, and against a slow twin.
#include <gtest/gtest.h>

#include <cmath>

#include "render/frame/appearance.h"
#include "render/viewer/controls/camera_control.h"
#include "render/viewer/controls/navigation.h"
#include "tests/render/textured_models.h"
#include "tests/render/viewer/two_tori.h"

namespace lodestone::viewer {
namespace {

class SurfacePick : public test::TwoTori {
 protected:
  const Selection nothing_{};
};

// All triangles of all drawn cells, projected and looked at in the picture: the nearest one over the point.
struct Seen {
  std::size_t model = 0;
  CellId cell;
  std::uint32_t triangle = 0;
  double depth = 2;
};
std::optional<Seen> slow_surface_at(const Frame& frame, double x, double y) {
  Seen nearest;
  for (std::size_t m = 0; m < frame.models.size(); ++m)
    for (const SelectedCell& selected : frame.models[m].selection->cells) {
      const MorphContext& morph = frame.models[m].morph;
      const Cell& cell = morph.hierarchy->cells[selected.cell];
      for (std::uint32_t t = 0; t < cell.triangles.size(); ++t) {
        std::array<Vec3d, 3> p;
        bool before_eye = true;
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3f w = cell.positions[cell.triangles[t].v[k]];
          const Vec3f parent =
              cell.parent == no_cell
                  ? w
                  : morph.hierarchy->cells[cell.parent].positions[cell.parents[cell.triangles[t].v[k]]];
          const Vec3f drawn = cell.parent == no_cell ? w : morph_position(morph, selected.level, w, parent);
          const auto at = project(frame.models[m].view_projection, frame.size, to_double(drawn));
          if (at)
            p[k] = to_double(*at);
          else
            before_eye = false;
        }
        if (!before_eye) continue;
        const auto area = [](Vec3d a, Vec3d b, double px, double py) {
          return (b.x - a.x) * (py - a.y) - (b.y - a.y) * (px - a.x);
        };
        const double whole = area(p[0], p[1], p[2].x, p[2].y);
        const double u = area(p[1], p[2], x, y) / whole, v = area(p[2], p[0], x, y) / whole;
        if (!(u >= 0 && v >= 0 && u + v <= 1)) continue;
        const double depth = u * p[0].z + v * p[1].z + (1 - u - v) * p[2].z;
        if (depth < nearest.depth) nearest = {m, selected.cell, t, depth};
      }
    }
  return nearest.depth < 2 ? std::optional(nearest) : std::nullopt;
}

TEST_F(SurfacePick, FindsWhatThePictureShows) {
  const Image image = draw();
  const Frame& frame = drawing_.frame(0);
  int hits = 0, second = 0, morphing = 0, other = 0;
  for (int y = 0; y < size.height; y += 5)
    for (int x = 0; x < size.width; x += 5) {
      const auto surface = drawing_.surface_at(0, size, x + 0.5, y + 0.5);
      const float depth = image.depth[static_cast<std::size_t>(y * size.width + x)];
      const auto slow = slow_surface_at(frame, x + 0.5, y + 0.5);
      ASSERT_EQ(surface.has_value(), slow.has_value());
      ASSERT_EQ(surface.has_value(), depth < 1) << x << ' ' << y;
      if (!surface) continue;
      ++hits;
      second += surface->model == 1;
      morphing += surface->morphing;
      // Two triangles may meet at the point: the depth tells.
      if (surface->model != slow->model || surface->cell != slow->cell || surface->triangle != slow->triangle) ++other;
      const auto at = project(frame.models[surface->model].view_projection, size, surface->point);
      ASSERT_TRUE(at);
      EXPECT_NEAR(at->x, x + 0.5, 0.01);
      EXPECT_NEAR(at->y, y + 0.5, 0.01);
      EXPECT_NEAR(at->z, depth, 1e-4);  // corners are snapped to parts of a pixel
      EXPECT_NEAR(at->z, slow->depth, 1e-5);
      // The same point of the scene, projected as notes over the picture are.
      const auto noted = drawing_.project(0, size, drawing_.in_scene(*surface));
      ASSERT_TRUE(noted);
      EXPECT_NEAR(noted->x, x + 0.5, 0.01);
      EXPECT_NEAR(noted->y, y + 0.5, 0.01);
    }
  EXPECT_GT(hits, 60);
  EXPECT_GT(second, 20);
  EXPECT_GT(morphing, 20);
  EXPECT_LT(other, 3);
  for (const auto& [x, y] : {std::pair<double, double>{-1, 5}, {5, -1}, {160, 5}, {5, 120}, {0, 0}, {std::nan(""), 5}})
    EXPECT_FALSE(drawing_.surface_at(0, size, x, y));
}

TEST_F(SurfacePick, TellsWhetherTheSurfaceMorphs) {
  int by_kind[2] = {0, 0};
  for (const double nearer : {1.0, 0.5, 0.25, 0.12}) {
    state_.camera = dolly(state_.camera, nearer);
    (void)draw();
    for (int y = 2; y < size.height; y += 9)
      for (int x = 2; x < size.width; x += 9) {
        const auto surface = drawing_.surface_at(0, size, x, y);
        if (!surface) continue;
        const ModelFrame& model = drawing_.frame(0).models[surface->model];
        const auto selected = std::ranges::find(model.selection->cells, surface->cell, &SelectedCell::cell);
        ASSERT_NE(selected, model.selection->cells.end());
        if (model.morph.hierarchy->cells[surface->cell].parent == no_cell) {
          EXPECT_FALSE(surface->morphing);
        } else {
          EXPECT_EQ(surface->morphing, selected->morphing);
          ++by_kind[selected->morphing];
        }
      }
  }
  EXPECT_GT(by_kind[0], 20);
  EXPECT_GT(by_kind[1], 20);
}

TEST_F(SurfacePick, FollowsAFrozenSelectionAndALowerResolution) {
  (void)draw();
  apply(Action::toggle_frozen, state_);
  state_.camera = dolly(orbit(state_.camera, 0.8, 0.1), 0.6);
  (void)draw();
  int hits = 0;
  for (int y = 2; y < size.height; y += 9)
    for (int x = 2; x < size.width; x += 9) {
      const auto surface = drawing_.surface_at(0, size, x, y);
      // Shown in twice as many pixels.
      const auto large = drawing_.surface_at(0, {320, 240}, 2 * x, 2 * y);
      ASSERT_EQ(surface.has_value(), large.has_value());
      ASSERT_EQ(surface.has_value(), slow_surface_at(drawing_.frame(0), x, y).has_value());
      if (!surface) continue;
      ++hits;
      EXPECT_EQ(surface->way, large->way);
    }
  EXPECT_GT(hits, 30);
}

// Pictures keep the depth of what a mask leaves.
TEST(SurfacePickAlpha, HolesOfMasksAreNotThere) {
  using namespace lodestone::test;
  for (const bool coloured : {false, true}) {
    auto model = std::make_shared<Hierarchy>(*textured_torus(coloured));
    model->textures.push_back(as_texture("lace", lace({64, 64}), TextureWrap::repeat, TextureWrap::mirror));
    const auto texture = static_cast<std::uint32_t>(model->textures.size() - 1);
    for (Material& m : model->materials) m = {.name = "lace", .texture = texture, .alpha_mode = AlphaMode::mask};
    model->materials[1].alpha_cutoff = 0.2f, model->materials[2].double_sided = false;
    TexturedFrame frame({"lace", {{model, {}, appearance_of(*model)}}});
    const auto scheduler = make_serial_scheduler();
    const Image image = frame.draw(*make_renderer("soft", *scheduler));
    SurfaceAlpha alpha;
    alpha.set_models(frame.hierarchies);
    alpha.prepare(frame.frame, *scheduler);
    int hits = 0, through = 0, wrong = 0;
    for (int y = 0; y < image.size.height; y += 2)
      for (int x = 0; x < image.size.width; x += 2) {
        const auto surface = surface_at(frame.frame, alpha, x + 0.5, y + 0.5);
        const float depth = image.depth[static_cast<std::size_t>(y * image.size.width + x)];
        hits += surface.has_value();
        wrong += surface.has_value() != (depth < 1);
        if (!surface || depth == 1) continue;
        const auto at = project(frame.frame.models[0].view_projection, image.size, surface->point);
        wrong += std::abs(at->z - depth) > 1e-4;
        through += slow_surface_at(frame.frame, x + 0.5, y + 0.5)->depth < at->z - 1e-4;
      }
    EXPECT_GT(hits, 2000);
    EXPECT_GT(through, 300) << "seen through holes";
    EXPECT_LT(wrong, hits / 200) << "along borders of holes";
  }
}

// One torus lies before the other in the middle of the picture.
TEST_F(SurfacePick, TakesTheLayerThatShowsMost) {
  (void)draw();
  const auto place = [&]() -> std::optional<Point> {
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        Frame other = drawing_.frame(0);
        const auto nearest = slow_surface_at(other, x + 0.5, y + 0.5);
        if (!nearest) continue;
        other.models[nearest->model].selection = &nothing_;
        if (slow_surface_at(other, x + 0.5, y + 0.5)) return Point{x + 0.5, y + 0.5};
      }
    return {};
  }();
  ASSERT_TRUE(place);
  const std::size_t front = drawing_.surface_at(0, size, place->x, place->y)->model, back = 1 - front;
  const auto picked = [&](float opacity) {
    model_->scene.models[front].appearance.opacity = opacity;
    drawing_.set_model(model_.get());
    (void)draw();
    return drawing_.surface_at(0, size, place->x, place->y)->model;
  };
  EXPECT_EQ(picked(0.8f), front);
  EXPECT_EQ(picked(0.1f), back);
  EXPECT_EQ(picked(0), back);
  EXPECT_EQ(picked(1), front);
}

TEST_F(SurfacePick, TellsTheFactsOfACell) {
  (void)draw();
  std::optional<SurfacePoint> surface;
  for (int x = 0; x < size.width && !(surface && surface->model == 1); ++x)
    surface = drawing_.surface_at(0, size, x, 60);
  ASSERT_TRUE(surface);
  const SurfaceFacts facts = facts_of(*surface, drawing_.scene_view(), state_.camera);
  const Hierarchy& hierarchy = drawing_.scene_view().hierarchy(1);
  const Cell& cell = hierarchy.cells[surface->cell];
  EXPECT_EQ(facts.model, "second");
  EXPECT_EQ(facts.level, hierarchy.level_of(surface->cell));
  EXPECT_EQ(facts.triangles, cell.triangles.size());
  EXPECT_FALSE(facts.measured);
  // The model is enlarged, and so is its error.
  EXPECT_NEAR(facts.error, 1.3 * hierarchy.transform.scale * double{cell.error}, 1e-12);
  EXPECT_EQ(facts.point, drawing_.in_scene(*surface));
  // A line of the error's length, across the view at the point, is as long in the picture.
  const auto up = axes_in_view(state_.camera);
  const Vec3d end = facts.point + facts.error * Vec3d{up[0].y, up[1].y, up[2].y};
  const auto from = drawing_.project(0, size, facts.point), to = drawing_.project(0, size, end);
  EXPECT_NEAR(std::hypot(to->x - from->x, to->y - from->y), facts.error_pixels, 1e-3 + 1e-3 * facts.error_pixels);
  EXPECT_GT(facts.error_pixels, 0);
}

}  // namespace
}  // namespace lodestone::viewer
