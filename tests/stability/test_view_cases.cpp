// Views that break renderers, camera jumps, kappa0 beside the reach, and models of very different size. On every
// backend: finite pictures without holes, the same as those of `soft`.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "render/scene/scene_view.h"
#include "tests/expect_error.h"
#include "tests/stability/view_cases.h"

namespace lodestone::test {
namespace {

constexpr const char* backends[] = {"soft", "gl", "null"};

class ViewCases : public ::testing::TestWithParam<std::tuple<std::size_t, const char*>> {
 protected:
  void SetUp() override {
    std::string why;
    renderer_ = renderer_if_possible(std::get<1>(GetParam()), *scheduler_, why);
    if (!renderer_) GTEST_SKIP() << why;
  }
  [[nodiscard]] static ViewCase view() { return view_cases()[std::get<0>(GetParam())]; }

  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
  std::unique_ptr<Renderer> renderer_;
};

void expect_finite(const Image& image) {
  std::size_t faults = 0;
  for (const float d : image.depth) faults += !(d >= 0 && d <= 1);
  EXPECT_EQ(faults, 0u);
}

// Pixels without a surface that are well inside the silhouette of another picture.
std::size_t holes(const Image& image, const Image& full, int tolerance) {
  const auto [width, height] = image.size;
  const auto covered = [width = width](const Image& of, int x, int y) {
    return of.depth[static_cast<std::size_t>(y * width + x)] < 1;
  };
  std::size_t count = 0;
  for (int y = tolerance; y + tolerance < height; ++y)
    for (int x = tolerance; x + tolerance < width; ++x) {
      if (covered(image, x, y)) continue;
      bool well_inside = true;
      for (int dy = -tolerance; dy <= tolerance; ++dy)
        for (int dx = -tolerance; dx <= tolerance; ++dx) well_inside &= covered(full, x + dx, y + dy);
      count += well_inside;
    }
  return count;
}

TEST_P(ViewCases, ArePicturesWithoutHoles) {
  const ViewCase scene = view();
  const DrawnScene drawn = draw_scene(scene, *renderer_),
                   reference = draw_scene(scene, *make_renderer("soft", *scheduler_));
  EXPECT_EQ(drawn.stats.cells, reference.stats.cells);
  EXPECT_EQ(drawn.stats.triangles, reference.stats.triangles);
  EXPECT_GT(drawn.stats.triangles, 0u);
  if (drawn.image.rgba.empty()) return;
  expect_finite(drawn.image);
  expect_conformance(drawn.image, reference.image);
  keep_picture("view_" + scene.name + "_" + std::get<1>(GetParam()), drawn.image);
  ViewCase finest = scene;
  finest.radii.kappa0 = 1e6f;
  const Image full = draw_scene(finest, *renderer_).image;
  EXPECT_EQ(holes(drawn.image, full, 3), 0u);
  const auto seen = std::ranges::count_if(drawn.image.depth, [](float d) { return d < 1; });
  if (scene.inside) {
    EXPECT_EQ(seen, 160 * 120);
  } else if (scene.name != "on_a_vertex_outwards") {
    EXPECT_GT(seen, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Views, ViewCases,
                         ::testing::Combine(::testing::Range(std::size_t{0}, view_cases().size()),
                                            ::testing::ValuesIn(backends)),
                         [](const auto& instance) {
                           return view_cases()[std::get<0>(instance.param)].name + "_" + std::get<1>(instance.param);
                         });

class ViewsOnBackend : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    std::string why;
    renderer_ = renderer_if_possible(GetParam(), *scheduler_, why);
    if (!renderer_) GTEST_SKIP() << why;
  }
  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
  std::unique_ptr<Renderer> renderer_;
};

// From twice as far with half the field of view a model looks nearly the same; from beyond that it is a parallel
// projection, the same from everywhere.
TEST_P(ViewsOnBackend, FromFarAwayAreAlike) {
  const auto at = [&](double distance) {
    return draw_scene(view_case("far", middle + distance * Vec3d{0.36, -0.8, 0.48}, middle, fov_at(distance)),
                      *renderer_)
        .image;
  };
  const Image reference = at(1e4);
  for (const double distance : {1e5, 1e6, 1e8, 1e10, 1e12}) {
    SCOPED_TRACE(distance);
    const Image image = at(distance);
    ASSERT_EQ(image.rgba.size(), reference.rgba.size());
    if (image.rgba.empty()) continue;
    expect_finite(image);
    const ImageDifference d = image_difference(image, reference, ConformanceTolerance{}.threshold);
    EXPECT_LE(d.differing_share, ConformanceTolerance{}.differing_share);
  }
}

// From so far a model is a point, and no direction in double precision leads to a part of it.
TEST_P(ViewsOnBackend, FromFartherAreEmptyOrRefused) {
  for (const double distance : {1e13, 1e15, 1e18}) {
    SCOPED_TRACE(distance);
    const Vec3d eye = middle + distance * Vec3d{0.36, -0.8, 0.48};
    expect_finite(draw_scene(view_case("far", eye, middle), *renderer_).image);
    expect_error_of<InputError>([&] { (void)draw_scene(view_case("far", eye, middle, fov_at(distance)), *renderer_); },
                                {"field of view is too narrow"});
  }
}

TEST_P(ViewsOnBackend, BeyondSinglePrecisionAreRefused) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto throws = [&](Vec3d position, const char* words) {
    ViewCase scene = view_case("refused", {0.5, -1, 0.5}, middle);
    scene.camera.position = position;
    try {
      (void)draw_scene(scene, *renderer_);
      ADD_FAILURE() << position.x;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  for (const double coordinate : {nan, infinity, -infinity}) {
    throws({coordinate, 0, 0}, "must be finite numbers");
    throws({0, 0, coordinate}, "must be finite numbers");
  }
  throws({1e21, 0, 0}, "too far away for single precision");  // its square has no float
  throws({1e300, 0, 0}, "too far away for single precision");
  throws({0, -1e60, 0}, "too far away for single precision");
}

// Every picture is that of its camera alone, whatever came before.
TEST_P(ViewsOnBackend, AfterAJumpAreThoseOfANewRenderer) {
  for (const ViewCase& scene : view_cases()) {
    const Image after = draw_scene(scene, *renderer_).image;
    const Image anew = draw_scene(scene, *make_renderer(GetParam(), *scheduler_)).image;
    EXPECT_TRUE(after.rgba == anew.rgba) << scene.name;
    EXPECT_TRUE(after.depth == anew.depth) << scene.name;
  }
}

// A model of a million units with one of a thousandth at some place.
struct HugeAndTiny {
  explicit HugeAndTiny(Vec3d tiny) {
    scene.models.resize(2);
    scene.models[0].name = "huge", scene.models[1].name = "tiny";
    scene.models[0].scale = 1e6, scene.models[1].scale = 1e-3;
    scene.models[0].anchor = scene.models[1].anchor = Anchor::centre;
    scene.models[1].position = tiny;
  }
  [[nodiscard]] Image draw(const Camera& camera, Renderer& renderer) {
    const OpenModel open{model().get()};
    view = std::make_unique<SceneView>(scene, std::vector(scene.models.size(), open));
    view->upload(renderer);
    EXPECT_TRUE(view->update(camera, view_config(scene, {160, 120})));
    EXPECT_GT(view->draw(renderer).triangles, 0u);
    return renderer.read_back();
  }

  Scene scene;
  std::unique_ptr<SceneView> view;
};

// The camera before both, before the small one with the huge one behind it, between the two, and far from both.
TEST_P(ViewsOnBackend, OfHugeAndTinyModelsTogether) {
  const Vec3d tiny{0, -4e6, 0};
  const double size = model()->transform.scale;
  HugeAndTiny both(tiny);
  for (const Camera& camera :
       {Camera{tiny + Vec3d{1e-3 * size, -2e-3 * size, 5e-4}, tiny},
        Camera{tiny + Vec3d{0, -1e-3 * size, 0}, {0, 0, 0}}, Camera{tiny + Vec3d{0, 2e-3 * size, 0}, tiny},
        Camera{{1e6, -9e6 * size, 3e6}, {0, 0, 0}}}) {
    const Image image = both.draw(camera, *renderer_);
    if (image.rgba.empty()) continue;
    expect_finite(image);
    expect_conformance(image, both.draw(camera, *make_renderer("soft", *scheduler_)));
    keep_picture(std::string("view_huge_tiny_") + std::to_string(camera.position.x) + GetParam(), image);
    EXPECT_GT(std::ranges::count_if(image.depth, [](float d) { return d < 1; }), 100);
  }
}

// Vertices of a model that lie before the eye and, as far as clip coordinates in float can tell, beyond the far plane.
std::size_t cut_off_by_far_plane(const ViewProjection& projection) {
  const auto& m = projection.m;
  std::size_t count = 0;
  for (const Cell& cell : model()->cells)
    for (const Vec3f& p : cell.positions) {
      const auto row = [&](std::size_t r) {
        return ((m[4 * r] * p.x + m[4 * r + 1] * p.y) + m[4 * r + 2] * p.z) + m[4 * r + 3];
      };
      count += row(3) > 0 && row(2) > row(3);
    }
  return count;
}

// The huge one is closed: every pixel sees it, and none of it is beyond the far plane. The camera is so near to the
// small one that the near plane cuts it off, so far from it that it is smaller than a pixel, or looks at it through a
// telescope.
TEST_P(ViewsOnBackend, OfATinyModelInsideOfAHugeOne) {
  const double size = model()->transform.scale, telescope = 2e-3 * size / 20;
  for (const Vec3d& tiny : {Vec3d{0, 0, 0}, Vec3d{0, -4e5, 0}, Vec3d{0, -1.4e6, 0}, Vec3d{3e5, 2e5, -1e5}})
    for (const auto& [from, fov] : {std::pair{Vec3d{1e-3 * size, -2e-3 * size, 5e-4}, 0.785},
                                    {Vec3d{0, -1e-3 * size, 0}, 0.785},
                                    {Vec3d{0, 2e-3 * size, 0}, 0.785},
                                    {Vec3d{0, -20, 3}, 0.785},
                                    {Vec3d{0, -20, 3}, telescope}}) {
      SCOPED_TRACE(std::to_string(tiny.y) + " from " + std::to_string(from.y) + " at " + std::to_string(fov));
      const Camera camera{tiny + from, tiny, {0, 0, 1}, fov};
      HugeAndTiny both(tiny);
      const Image image = both.draw(camera, *renderer_);
      for (const ModelFrame& drawn : both.view->frame().models)
        EXPECT_EQ(cut_off_by_far_plane(drawn.view_projection), 0u);
      if (image.rgba.empty()) continue;
      expect_finite(image);
      expect_conformance(image, both.draw(camera, *make_renderer("soft", *scheduler_)));
      keep_picture(
          "view_tiny_inside_" + std::to_string(tiny.y) + std::to_string(from.y) + std::to_string(fov) + GetParam(),
          image);
      EXPECT_EQ(std::ranges::count_if(image.depth, [](float d) { return d < 1; }), 160 * 120);
      both.scene.models.pop_back();
      const double differing = image_difference(image, both.draw(camera, *renderer_), 8).differing_share;
      EXPECT_EQ(differing > 0.05, fov == telescope) << differing;
    }
}

// A uniform kappa0 at the reach, a hair below and a hair above it.
TEST_P(ViewsOnBackend, BesideTheReachAreFinite) {
  const float rho = greatest_reach(*model(), DistanceMetric::euclidean);
  for (const float kappa0 : {rho, std::nextafter(rho, 0.0f), std::nextafter(rho, 9.0f), 0.9999f * rho, 1.0001f * rho}) {
    ViewCase scene = view_case("beside", {0.4, -0.5, 0.6}, middle);
    scene.radii.rule = RadiiRule::uniform;
    scene.radii.kappa0 = kappa0;
    const DrawnScene drawn = draw_scene(scene, *renderer_),
                     reference = draw_scene(scene, *make_renderer("soft", *scheduler_));
    EXPECT_EQ(drawn.stats.triangles, reference.stats.triangles);
    if (drawn.image.rgba.empty()) continue;
    expect_finite(drawn.image);
    expect_conformance(drawn.image, reference.image);
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, ViewsOnBackend, ::testing::ValuesIn(backends),
                         [](const auto& instance) { return std::string(instance.param); });

}  // namespace
}  // namespace lodestone::test
