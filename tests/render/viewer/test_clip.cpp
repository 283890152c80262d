// The clipping plane: the plane of a choice, and the pictures of both backends against what lies behind it.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "render/effects/cut_face.h"
#include "render/viewer/controls/camera_control.h"
#include "tests/render/conformance.h"
#include "tests/render/viewer/two_tori.h"

namespace lodestone::viewer {
namespace {

TEST(ClipChoice, IsAPlaneAcrossTheScene) {
  const Sphere scene{{1, 2, 3}, 4};
  ClipChoice choice;
  EXPECT_EQ(plane_of(choice, scene), std::nullopt);
  choice.on = true;
  choice.axis = 1;
  choice.place = 0.5f;  // y = 4
  const auto kept = [&](Vec3d p) {
    const ClipPlane plane = *plane_of(choice, scene);
    return dot(plane.normal, p) >= plane.offset;
  };
  EXPECT_TRUE(kept({9, 3.9, 9}));
  EXPECT_FALSE(kept({-9, 4.1, -9}));
  choice.other = true;
  EXPECT_FALSE(kept({9, 3.9, 9}));
  EXPECT_TRUE(kept({-9, 4.1, -9}));
  choice.place = std::nanf("");
  EXPECT_TRUE(kept({0, 2.1, 0}));
  EXPECT_FALSE(kept({0, 1.9, 0}));
}

TEST(ClipChoice, BoxesAreOnASideOrAcross) {
  const Plane plane{{1, -1, 0}, 0.5f};  // x - y + 0.5 >= 0
  EXPECT_EQ(side_of(plane, {{0, 0, 0}, {0.4f, 0.4f, 1}}), 1);
  EXPECT_EQ(side_of(plane, {{0, 0, 0}, {1, 1, 1}}), 0);
  EXPECT_EQ(side_of(plane, {{0, 2, 0}, {1, 3, 1}}), -1);
}

class ClipDrawn : public test::TwoTori, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    try {
      own_ = make_renderer(GetParam(), *scheduler_);
    } catch (const UnsupportedError& error) {
      GTEST_SKIP() << error.what();
    }
    drawing_.set_renderer(own_.get());
  }
  Image picture() {
    (void)drawing_.draw(state_, 0, size);
    return own_->read_back();
  }
  // Pixels that disagree with the surface that a ray finds: drawn or not and, with one sample, how far away.
  int wrong_pixels(const Image& image) const {
    const auto plane = plane_of(state_.clip, drawing_.bounding_sphere());
    const bool central = state_.current().samples == 1;  // otherwise the depth is that of a sample beside the centre
    int wrong = 0;
    for (int y = 0; y < size.height; y += 5)
      for (int x = 0; x < size.width; x += 5) {
        const auto surface = drawing_.surface_at(0, size, x + 0.5, y + 0.5);
        const float depth = image.depth[static_cast<std::size_t>(y * size.width + x)];
        const bool drawn = depth < 1;
        wrong += surface.has_value() != drawn;
        if (!surface || !drawn) continue;
        const auto at = project(drawing_.frame(0).models[surface->model].view_projection, size, surface->point);
        wrong += central && std::abs(at->z - depth) > 1e-4;
        EXPECT_GE(dot(plane->normal, drawing_.in_scene(*surface)), plane->offset - 1e-5);
      }
    return wrong;
  }
  std::unique_ptr<Renderer> own_;
};

TEST_P(ClipDrawn, ShowsNothingBehindThePlane) {
  const Image plain = picture();
  for (const int samples : {1, 4})
    for (int axis = 0; axis < 3; ++axis)
      for (const bool other : {false, true}) {
        state_.current().samples = samples;
        state_.clip = {true, axis, 0.1f * static_cast<float>(axis), other};
        const Image clipped = picture();
        EXPECT_NE(clipped.rgba, plain.rgba);
        EXPECT_LT(wrong_pixels(clipped), 8) << axis << other << samples;  // along the cut
      }
  state_.current().samples = 1;
  state_.clip.on = false;
  EXPECT_EQ(picture().rgba, plain.rgba);
}

// A point of the plane is inside if the drawn surface is crossed an odd number of times on the way to the eye, through
// the part that is cut away.
bool is_inside(const ModelFrame& model, Vec3d from, Vec3d eye) {
  int crossings = 0;
  for (const SelectedCell& selected : model.selection->cells) {
    const Cell& cell = model.morph.hierarchy->cells[selected.cell];
    std::vector<Vec3f> p(cell.positions.size());
    morph_cell(model.morph, selected.cell, p);
    for (const Triangle& t : cell.triangles) {
      const Vec3d a = to_double(p[t.v[0]]), b = to_double(p[t.v[1]]), c = to_double(p[t.v[2]]);
      const auto volume = [](Vec3d s, Vec3d u, Vec3d v, Vec3d w) { return dot(u - s, cross(v - s, w - s)) > 0; };
      crossings += volume(from, a, b, c) != volume(eye, a, b, c) &&
                   volume(from, eye, a, b) == volume(from, eye, b, c) &&
                   volume(from, eye, b, c) == volume(from, eye, c, a);
    }
  }
  return crossings % 2 != 0;
}

// The point at which the line from the near plane to the far one meets the plane.
std::optional<Vec3d> on_plane(const ModelFrame& model, ImageSize size, double x, double y) {
  const Unprojection unproject(model.view_projection, size);
  const Vec3d near = unproject(x, y, 0), along = unproject(x, y, 1) - near, n = to_double(model.clip->n);
  const double way = -(dot(n, near) + double{model.clip->d}) / dot(n, along);
  return way > 0 && way < 1 ? std::optional(near + way * along) : std::nullopt;
}

TEST_P(ClipDrawn, FillsTheCutOfASolid) {
  state_.camera = orbit(state_.camera, 0.7, 0.2);  // no plane is seen edge-on
  for (const int samples : {1, 4})
    for (const int axis : {0, 1, 2}) {
      state_.current().samples = samples;
      state_.clip = {true, axis, 0, false};
      (void)picture();
      state_.clip.other = std::ranges::none_of(
          drawing_.frame(0).models, [](const ModelFrame& m) { return distance_from(*m.clip, m.morph.viewpoint) < 0; });
      const Image image = picture();
      const Frame& frame = drawing_.frame(0);
      lodestone::test::keep_picture("cut_" + std::string(GetParam()) + std::to_string(samples) + std::to_string(axis),
                                    image);
      int cut = 0, wrong = 0, wrong_colour = 0;
      for (int y = 0; y < size.height; y += 2)
        for (int x = 0; x < size.width; x += 2) {
          bool inside = false;
          for (const ModelFrame& model : frame.models)
            if (const auto p = on_plane(model, size, x + 0.5, y + 0.5))
              inside = inside || is_inside(model, *p, to_double(model.morph.viewpoint));
          const auto surface = drawing_.surface_at(0, size, x + 0.5, y + 0.5);
          wrong += inside != (surface && surface->cut);
          if (!inside) continue;
          ++cut;
          const std::uint8_t* rgb = &image.rgba[4 * static_cast<std::size_t>(y * size.width + x)];
          wrong_colour += rgb[0] < rgb[1] + 30 || rgb[1] < rgb[2] + 10;  // no other surface is red
        }
      EXPECT_GT(cut, 80) << axis;
      EXPECT_LT(wrong, 4) << axis;
      EXPECT_LT(wrong_colour, 10 * samples) << axis << " with " << samples << " samples, along the borders";
    }
}

TEST_P(ClipDrawn, BackendsFillAlike) {
  const auto soft = make_renderer("soft", *scheduler_);
  state_.camera = orbit(state_.camera, 0.7, 0.2);
  state_.looks.fog = {{0.7f, 0.75f, 0.8f}, 0.3f};
  state_.looks.lighting.directional = {0.6f, false, 256};
  state_.looks.ambient_occlusion = {0.8f, 0.05f};
  state_.clip = {true, 2, 0.1f, false};
  for (const int samples : {1, 4}) {
    state_.current().samples = samples;
    const Image own = picture();
    EXPECT_FALSE(effects::cut_faces(drawing_.frame(0)).empty());
    drawing_.set_renderer(soft.get());
    (void)drawing_.draw(state_, 0, size);
    EXPECT_LT(image_difference(own, soft->read_back()).differing, 60u) << samples;
    drawing_.set_renderer(own_.get());
  }
}

TEST_P(ClipDrawn, LeavesOpenAndTransparentSurfacesOpen) {
  state_.camera = orbit(state_.camera, 0.7, 0.2);
  state_.clip = {true, 2, 0, false};
  (void)picture();
  EXPECT_FALSE(effects::cut_faces(drawing_.frame(0)).empty());
  model_->scene.models[0].appearance.opacity = model_->scene.models[1].appearance.opacity = 0.5f;
  drawing_.set_model(model_.get());
  (void)picture();
  EXPECT_TRUE(effects::cut_faces(drawing_.frame(0)).empty());
  const std::string file = (folder_ / "terrain.lode").string();
  (void)write_lode(lodestone::test::naive_hierarchy(lodestone::test::terrain_mesh(32), 3).hierarchy, file);
  Model open;
  open.scene = scene_of(file);
  open.opened = OpenScene(open.scene, {}, *scheduler_);
  drawing_.set_model(&open);
  (void)picture();
  EXPECT_TRUE(effects::cut_faces(drawing_.frame(0)).empty());
  drawing_.set_model(nullptr);
}

TEST_P(ClipDrawn, WorksWithEdgesCountsShadowsAndHeatMaps) {
  state_.clip = {true, 0, 0, false};
  state_.looks.lighting.directional = {0.8f, true, 256};
  for (bool ViewSettings::*looks : {&ViewSettings::wireframe, &ViewSettings::errors, &ViewSettings::tint}) {
    state_.current().*looks = true;
    EXPECT_LT(wrong_pixels(picture()), 8);
    state_.current().*looks = false;
  }
  state_.current().overdraw = true;
  const Image counts = picture();
  state_.clip.on = false;
  EXPECT_NE(picture().rgba, counts.rgba);
}

TEST_P(ClipDrawn, EndsLeaveAllOrNothing) {
  const Image plain = picture();
  state_.clip = {true, 2, 1, false};
  EXPECT_EQ(picture().rgba, plain.rgba);
  state_.clip.other = true;
  const Image nothing = picture();
  EXPECT_TRUE(std::ranges::all_of(nothing.depth, [](float depth) { return depth == 1; }));
}

TEST_P(ClipDrawn, CutsAFrozenSelectionToo) {
  apply(Action::toggle_frozen, state_);
  const Image plain = picture();
  apply(Action::toggle_clip, state_);
  EXPECT_LT(wrong_pixels(picture()), 8);
  apply(Action::toggle_clip, state_);
  EXPECT_EQ(picture().rgba, plain.rgba);
}

TEST_P(ClipDrawn, RefusesAPlaneThatIsNone) {
  (void)picture();
  Frame frame = drawing_.frame(0);
  frame.models[0].clip = Plane{{std::nanf(""), 0, 0}, 0};
  EXPECT_THROW((void)own_->draw(frame), InputError);
}

// By its distance from the eye, as any surface: the colour of a point does not tell where in the picture it is.
TEST(CutFaces, FogThickensWithTheDistance) {
  Frame frame;
  frame.size = {640, 360};
  frame.lens = {.tan_x = 0.8f, .tan_y = 0.45f, .near = 0.1f, .far = 20};
  frame.settings.fog = {{0, 0, 1}, 0.3f};
  frame.only().effects = {Effect::fog};
  const effects::CutFace face{&frame.only(), {}, {1, 0, 0}};
  for (const Vec3d& p :
       {Vec3d{0, 0, 2}, Vec3d{1, 0.5, 2}, Vec3d{-1, 0.5, 2}, Vec3d{3, -2, 9}}) {  // z: away from the eye
    const double x = (p.x / (p.z * double{frame.lens.tan_x}) + 1) / 2 * frame.size.width,
                 y = (p.y / (p.z * double{frame.lens.tan_y}) + 1) / 2 * frame.size.height;
    const double near = frame.lens.near, far = frame.lens.far, z = (far - near * far / p.z) / (far - near);
    const double clear = std::exp(-0.3 * length(p));
    const Vec3f colour = effects::cut_colour(face, frame, x, y, z);
    EXPECT_NEAR(colour.x, clear, 1e-5);
    EXPECT_NEAR(colour.z, 1 - clear, 1e-5);
  }
  frame.only().effects = {};
  EXPECT_EQ(effects::cut_colour(face, frame, 10, 10, 0.5), face.colour);
}

INSTANTIATE_TEST_SUITE_P(Backends, ClipDrawn, testing::Values("soft", "gl"));

}  // namespace
}  // namespace lodestone::viewer
