// Every backend draws the same scenes; pictures agree with those of `soft`, counts with those of `null`.
#include <cstdlib>
#include <tuple>

#include "tests/render/conformance.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

// To look at: with LODESTONE_PICTURES=DIR in the environment the pictures are written there.
void keep_picture(const std::string& name, const Image& image) {
  if (const char* folder = std::getenv("LODESTONE_PICTURES"))
    write_png(std::string(folder) + "/" + name + ".png", image);
}

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

TEST(RendererFactory, RefusesUnknownNames) {
  const auto scheduler = make_serial_scheduler();
  EXPECT_THROW((void)make_renderer("vulkan", *scheduler), InputError);
}

}  // namespace
}  // namespace lodestone
