// Coloured, textured and normal-mapped scenes: backends agree, effects that find nothing to show change nothing.
#include <gtest/gtest.h>

#include <cstdlib>

#include "render/backends/make_renderer.h"
#include "render/backends/soft/soft_renderer.h"
#include "render/frame/appearance.h"
#include "tests/render/conformance.h"
#include "tests/render/textured_models.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

const EffectRequest all_effects{EffectRequest::Kind::all, {}, {}};

std::vector<TexturedScene> textured_scenes() {
  static const auto torus = textured_torus(), coloured = textured_torus(true);
  static const auto bare = detail::shared(torus_mesh(96, 48), 3);
  const Appearance own = appearance_of(*torus);
  Appearance flat = own, without_textures = own, only_colours = own;
  flat.smooth = false;
  without_textures.textures = without_textures.normal_maps = false;
  only_colours.textures = only_colours.normal_maps = false;
  const Vec3f apart{0.45f, 0.6f, 0.15f};
  std::vector<TexturedScene> scenes;
  scenes.push_back({"textured", {{torus, {}, own}}});
  scenes.push_back({"coloured", {{coloured, {}, only_colours}}});
  scenes.push_back({"coloured_and_textured", {{coloured, {}, own}}});
  scenes.push_back({"mixed", {{torus, {}, own}, {bare, apart, {}}, {coloured, -1.0f * apart, only_colours}}});
  scenes.push_back({"switched_off", {{torus, {}, without_textures}, {torus, apart, own}}});
  scenes.push_back({"flat", {{torus, {}, flat}}});
  TexturedScene magnified{"magnified", {{torus, {}, own}}};
  magnified.eye = {0.5, 0.12, 0.4}, magnified.target = {0.5, 0.2, 0};
  scenes.push_back(magnified);
  TexturedScene minified{"minified", {{torus, {}, own}}};
  minified.eye = {0.9, -5, 3};
  scenes.push_back(minified);
  TexturedScene inside{"near_plane", {{torus, {}, own}}};
  inside.eye = {0.12, 0.5, 0.13}, inside.target = {0.2, 0.9, 0.2};
  scenes.push_back(inside);
  TexturedScene coarse{"coarse", {{torus, {}, own}}};
  coarse.kappa0 = 0.01f;
  scenes.push_back(coarse);
  TexturedScene unlit{"unlit", {{torus, {}, own}}};
  unlit.settings.lighting.ambient = 1;
  scenes.push_back(unlit);
  TexturedScene tinted{"tinted", {{coloured, {}, own}}};
  tinted.settings.level_tint = 0.3f;
  scenes.push_back(tinted);
  add_multisampled(scenes, {"textured", "mixed", "magnified", "minified", "near_plane"});
  return scenes;
}

class TexturedScenes : public ::testing::TestWithParam<std::size_t> {
 protected:
  static const TexturedScene& scene() {
    static const std::vector<TexturedScene> scenes = textured_scenes();
    return scenes[GetParam()];
  }
  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
};

TEST_P(TexturedScenes, GlAgreesWithSoft) {
  std::string why;
  const auto gl = renderer_if_possible("gl", *scheduler_, why);
  if (!gl) GTEST_SKIP() << why;
  TexturedFrame frame(scene());
  const Image image = frame.draw(*gl), reference = frame.draw(*make_renderer("soft", *scheduler_));
  keep_picture(scene().name + "_gl", image);
  keep_picture(scene().name + "_soft", reference);
  expect_conformance(image, reference);
  // All effects on: the same picture within the tolerance.
  TexturedFrame all(scene(), all_effects);
  expect_conformance(all.draw(*gl), reference);
}

TEST_P(TexturedScenes, AllEffectsGiveThePictureOfThoseCalledFor) {
  TexturedFrame planned(scene()), all(scene(), all_effects);
  const auto soft = make_renderer("soft", *scheduler_);
  const Image image = planned.draw(*soft);
  EXPECT_TRUE(image.rgba == all.draw(*soft).rgba);
}

TEST_P(TexturedScenes, SameBytesForAllThreadsAndInstructionSets) {
  TexturedFrame frame(scene());
  const Image reference = frame.draw(*make_soft_renderer(*scheduler_, {InstructionSet::plain}));
  const auto threads = make_tbb_scheduler(3);
  EXPECT_TRUE(frame.draw(*make_soft_renderer(*threads)).rgba == reference.rgba);
}

TEST_P(TexturedScenes, CountOnlyWhatIsCalledFor) {
  TexturedFrame frame(scene());
  (void)frame.draw(*make_renderer("soft", *scheduler_));
  const EffectSet called = frame.frame.all_effects();
  for (const Effect effect : {Effect::vertex_colours, Effect::texture, Effect::normal_map})
    EXPECT_EQ(frame.stats.work.contains(std::string(name_of(effect))), called.contains(effect)) << name_of(effect);
  EXPECT_EQ(frame.stats.work.contains("decoded textures"),
            called.contains(Effect::texture) || called.contains(Effect::normal_map));
  EXPECT_TRUE(frame.stats.warnings.empty());
}

// Missing textures have a conspicuous colour and one warning.
TEST(MissingTextures, AreDrawnMarkedWithAWarning) {
  auto model = std::make_shared<Hierarchy>(*textured_torus());
  for (Texture& texture : model->textures) texture.bytes.resize(texture.bytes.size() / 2);
  TexturedScene scene{"missing", {{model, {}, appearance_of(*model)}}};
  scene.settings.lighting.ambient = 1;
  const auto scheduler = make_serial_scheduler();
  for (const char* backend : {"soft", "gl"}) {
    std::string why;
    const auto renderer = renderer_if_possible(backend, *scheduler, why);
    if (!renderer) continue;
    TexturedFrame frame(scene);
    const Image image = frame.draw(*renderer);
    ASSERT_EQ(frame.stats.warnings.size(), 3u) << backend;
    EXPECT_NE(frame.stats.warnings[0].find("'motley'"), std::string::npos) << frame.stats.warnings[0];
    EXPECT_TRUE(renderer->draw(frame.frame).warnings.empty());
    std::size_t magenta = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
      magenta += image.rgba[i] > 200 && image.rgba[i + 1] < 30 && image.rgba[i + 2] > 200;
    EXPECT_GT(magenta, 500u) << backend;
  }
}

INSTANTIATE_TEST_SUITE_P(All, TexturedScenes, ::testing::Range(std::size_t{0}, textured_scenes().size()),
                         [](const auto& instance) { return textured_scenes()[instance.param].name; });

}  // namespace
}  // namespace lodestone
