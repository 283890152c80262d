// Every backend draws the same scenes; pictures agree with those of `soft`, counts with those of `null`.
#include <functional>
#include <limits>
#include <tuple>

#include "render/backends/make_renderer.h"
#include "tests/render/conformance.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

class Conformance : public ::testing::TestWithParam<std::tuple<std::size_t, const char*>> {
 protected:
  static const ConformanceScene& scene() {
    static const std::vector<ConformanceScene> scenes = conformance_scenes();
    return scenes[std::get<0>(GetParam())];
  }
  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
};

TEST_P(Conformance, PictureAndCounts) {
  std::string why;
  const auto renderer = renderer_if_possible(std::get<1>(GetParam()), *scheduler_, why);
  if (!renderer) GTEST_SKIP() << why;
  const DrawnScene drawn = draw_scene(scene(), *renderer);
  const DrawnScene reference = draw_scene(scene(), *make_renderer("soft", *scheduler_));
  EXPECT_EQ(renderer->name(), std::get<1>(GetParam()));
  EXPECT_EQ(drawn.stats.cells, reference.stats.cells);
  EXPECT_EQ(drawn.stats.triangles, reference.stats.triangles);
  EXPECT_EQ(drawn.stats.milliseconds.count("total"), 1u);
  if (drawn.image.rgba.empty()) {
    EXPECT_STREQ(std::get<1>(GetParam()), "null");
  } else {
    expect_conformance(drawn.image, reference.image);
    keep_picture(scene().name + "_" + std::get<1>(GetParam()), drawn.image);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Conformance,
                         ::testing::Combine(::testing::Range(std::size_t{0}, conformance_scenes().size()),
                                            ::testing::Values("soft", "gl", "null")),
                         [](const auto& instance) {
                           return conformance_scenes()[std::get<0>(instance.param)].name + "_" +
                                  std::get<1>(instance.param);
                         });

// Every backend refuses the frames that check_frame refuses, and keeps its picture.
TEST(Renderers, RefuseFramesThatCannotBeDrawn) {
  const ConformanceScene scene = conformance_scenes().front();
  const auto scheduler = make_serial_scheduler();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const std::vector<std::function<void(Frame&)>> faults{
      [](Frame& f) {
        f.size = {0, 0};
      },
      [](Frame& f) { f.size.width = -5; },
      [](Frame& f) { f.size.height = 0; },
      [](Frame& f) { f.samples = 0; },
      [](Frame& f) { f.samples = 3; },
      [](Frame& f) { f.only().view_projection.m[5] = nan; },
      [](Frame& f) { f.only().view_projection.m[15] = infinity; },
      [](Frame& f) { f.only().morph.viewpoint.y = nan; },
      [](Frame& f) { f.only().towards_eye.z = nan; },
      [](Frame& f) { f.only().towards_light.x = infinity; },
      [](Frame& f) { f.only().light_projection.m[3] = nan; },
      [](Frame& f) { f.only().appearance.opacity = 1.5f; },
      [](Frame& f) { f.settings.lighting.ambient = -0.1f; },
      [](Frame& f) { f.settings.lighting.head = nan; },
      [](Frame& f) { f.settings.lighting.directional.strength = -1; },
      [](Frame& f) { f.settings.fog.density = infinity; },
      [](Frame& f) { f.settings.ambient_occlusion.strength = 2; },
      [](Frame& f) { f.settings.ambient_occlusion.radius = -1; },
      [](Frame& f) { f.settings.level_tint = nan; },
      [](Frame& f) { f.settings.wireframe = 2; },
  };
  for (const char* backend : {"soft", "gl", "null"}) {
    std::string why;
    const auto renderer = renderer_if_possible(backend, *scheduler, why);
    if (!renderer) continue;
    const Image before = draw_scene(scene, *renderer).image;
    const Radii radii = make_radii(*scene.hierarchy, scene.radii);
    const Selection none;
    Frame frame;
    frame.only().morph = {scene.hierarchy.get(), &radii, scene.blend, {0.5f, 0.5f, 2}};
    frame.only().selection = &none;
    frame.size = {16, 16};
    for (std::size_t i = 0; i < faults.size(); ++i) {
      Frame faulty = frame;
      faults[i](faulty);
      EXPECT_THROW((void)renderer->draw(faulty), InputError) << backend << ", fault " << i;
      EXPECT_TRUE(renderer->read_back().rgba == before.rgba) << backend << ", fault " << i;
    }
    if (!before.rgba.empty()) {  // larger than a picture of this backend can be
      Frame large = frame;
      large.size = {std::string(backend) == "soft" ? 20000 : 1 << 20, 10};
      EXPECT_THROW((void)renderer->draw(large), InputError) << backend;
    }
    EXPECT_NO_THROW((void)renderer->draw(frame)) << backend;
  }
}

TEST(RendererFactory, RefusesUnknownNames) {
  const auto scheduler = make_serial_scheduler();
  EXPECT_THROW((void)make_renderer("vulkan", *scheduler), InputError);
}

}  // namespace
}  // namespace lodestone
