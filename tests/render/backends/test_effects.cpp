// The effects that are passes or steps of their own: both backends draw the same, and what asks for nothing changes
// nothing.
#include <tuple>

#include "render/backends/soft/soft_renderer.h"
#include "render/effects/effect_info.h"
#include "tests/render/effect_scenes.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

const std::vector<EffectScene>& scenes() {
  static const std::vector<EffectScene> all = effect_scenes();
  return all;
}

DrawnScene draw_soft(const EffectScene& scene, const SoftConfig& config = {}) {
  const auto scheduler = make_serial_scheduler();
  return draw_effects(scene, *make_soft_renderer(*scheduler, config));
}

class EffectConformance : public ::testing::TestWithParam<std::size_t> {};

TEST_P(EffectConformance, GlDrawsWhatSoftDraws) {
  const EffectScene& scene = scenes()[GetParam()];
  const DrawnScene soft = draw_soft(scene);
  keep_picture(scene.name + "_soft", soft.image);
  const auto scheduler = make_serial_scheduler();
  std::string why;
  const auto gl = renderer_if_possible("gl", *scheduler, why);
  if (!gl) GTEST_SKIP() << why;
  const DrawnScene drawn = draw_effects(scene, *gl);
  keep_picture(scene.name + "_gl", drawn.image);
  EXPECT_EQ(drawn.stats.cells, soft.stats.cells);
  EXPECT_EQ(drawn.stats.triangles, soft.stats.triangles);
  expect_conformance(drawn.image, soft.image);
  const ImageDifference d = image_difference(drawn.image, soft.image);
  RecordProperty("differing", std::to_string(d.differing));
  RecordProperty("mean", std::to_string(d.mean_absolute));
}

TEST_P(EffectConformance, SameBytesFromEveryInstructionSetAndAnyNumberOfThreads) {
  const EffectScene& scene = scenes()[GetParam()];
  const Image serial = draw_soft(scene).image;
  const Image baseline = draw_soft(scene, {InstructionSet::plain}).image;
  EXPECT_TRUE(baseline.rgba == serial.rgba);
  EXPECT_TRUE(baseline.depth == serial.depth);
  const auto scheduler = make_tbb_scheduler(3);
  const Image parallel = draw_effects(scene, *make_soft_renderer(*scheduler)).image;
  EXPECT_TRUE(parallel.rgba == serial.rgba);
  EXPECT_TRUE(parallel.depth == serial.depth);
}

INSTANTIATE_TEST_SUITE_P(Scenes, EffectConformance, ::testing::Range(std::size_t{0}, effect_scenes().size()),
                         [](const auto& instance) { return effect_scenes()[instance.param].name; });

// Effects that are on and whose parameters ask for nothing.
TEST(Effects, ChangeNoBitWhereNothingIsAskedFor) {
  for (const int samples : {1, 4}) {
    EffectScene plain = detail::still_life("plain");
    plain.samples = samples;
    plain.settings = {};
    plain.settings.lighting.head = 0.7f;
    const Image expected = draw_soft(plain).image;
    EffectScene all = plain;
    for (const Effect effect : {Effect::directional_light, Effect::shadow, Effect::wireframe, Effect::fog,
                                Effect::transparency, Effect::ambient_occlusion, Effect::overdraw}) {
      all.of_models.insert(effect);
      all.of_picture.insert(effect);
    }
    const DrawnScene drawn = draw_soft(all);
    EXPECT_TRUE(drawn.image.rgba == expected.rgba);
    EXPECT_TRUE(drawn.image.depth == expected.depth);
    for (const char* work : {"shadow triangles", "transparency", "covered samples", "occlusion pixels"})
      EXPECT_EQ(drawn.stats.work.count(work), 0u) << work;
  }
}

}  // namespace
}  // namespace lodestone
