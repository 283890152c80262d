// The planner, and that a plan changes no picture: what a scene does not call for may as well be left out.
#include <gtest/gtest.h>

#include <functional>

#include "core/base/error.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"
#include "render/effects/plan.h"
#include "render/scene/scene_view.h"
#include "tests/render/conformance.h"

namespace lodestone {
namespace {

using test::renderer_if_possible;

// A request of a scene, by name.
struct Wish {
  std::string name;
  std::function<void(Scene&)> apply;
};

std::vector<Wish> wishes() {
  return {
      {"plain", [](Scene&) {}},
      {"unlit", [](Scene& s) { s.settings.lighting.ambient = 1; }},
      {"dark", [](Scene& s) { s.settings.lighting.head = 0; }},
      {"flat", [](Scene& s) { s.models[0].appearance.smooth = false; }},
      {"coloured",
       [](Scene& s) {
         s.models[1].colour = Vec3f{0.2f, 0.7f, 1};
       }},
      {"tinted", [](Scene& s) { s.settings.level_tint = 0.6f; }},
      {"foggy", [](Scene& s) { s.settings.fog.density = 0.3f; }},
      {"sunny",
       [](Scene& s) {
         s.settings.lighting.directional = {0.8f, false};
       }},
      {"shadowed",
       [](Scene& s) {
         s.settings.lighting.directional = {0.8f, true};
       }},
      {"transparent", [](Scene& s) { s.models[0].appearance.opacity = 0.4f; }},
      {"occluded",
       [](Scene& s) {
         s.settings.ambient_occlusion = {0.8f, 0.3f};
       }},
      {"wireframe", [](Scene& s) { s.settings.wireframe = 0.7f; }},
      {"overdraw", [](Scene& s) { s.settings.overdraw = true; }},
      {"foggy_tinted_flat",
       [](Scene& s) {
         s.settings.fog.density = 0.3f;
         s.settings.level_tint = 1;
         s.models[1].appearance.smooth = false;
       }},
  };
}

// A torus before a piece of terrain, turned and of another size.
class TwoModels {
 public:
  TwoModels()
      : torus_(test::naive_hierarchy(test::torus_mesh(96, 48), 3)),
        hills_(test::naive_hierarchy(test::terrain_mesh(48), 2)) {
    scene.models.resize(2);
    scene.models[0].name = "torus";
    scene.models[1].name = "hills";
    scene.models[1].position = {0.4, 0.8, -0.7};
    scene.models[1].rotation = {0, 20, 30};
    scene.models[1].scale = 1.7;
    scene.radii.kappa0 = 2;
  }
  [[nodiscard]] SceneView view() const { return {scene, {{&torus_.hierarchy}, {&hills_.hierarchy}}}; }

  Scene scene;

 private:
  test::NaiveHierarchy torus_, hills_;
};

struct Drawn {
  Image image;
  FrameStats stats;
  Frame frame;
};
Drawn draw(const TwoModels& models, Renderer& renderer, int samples = 1) {
  SceneView view = models.view();
  view.upload(renderer);
  ViewConfig config = view_config(models.scene, {200, 150});
  config.samples = samples;
  view.update(orbit_path(view.bounding_sphere(), 8)[5], config);
  Drawn drawn;
  drawn.stats = view.draw(renderer);
  drawn.image = renderer.read_back();
  drawn.frame = view.frame();
  return drawn;
}

TEST(EffectPlan, NamesAndLists) {
  EXPECT_EQ(parse_effects("auto"), EffectRequest{});
  EXPECT_EQ(parse_effects("all").kind, EffectRequest::Kind::all);
  EXPECT_TRUE(parse_effects("none").listed.empty());
  EXPECT_EQ(parse_effects("fog,head-light").listed, (EffectSet{Effect::head_light, Effect::fog}));
  for (const char* wrong : {"", "fog,", "Fog", "fog head-light", "bloom"})
    EXPECT_THROW((void)parse_effects(wrong), InputError) << wrong;
  for (const char* text : {"auto", "all", "none", "fog", "head-light,fog"})
    EXPECT_EQ(to_text(parse_effects(text)), text);
  EXPECT_EQ(to_text(parse_effects("fog,head-light,fog")), "head-light,fog");
  for (std::size_t k = 0; k < effect_count; ++k) {
    const auto effect = static_cast<Effect>(k);
    EXPECT_EQ(effect_named(name_of(effect)), effect);
    EXPECT_EQ(info_of(effect).effect, effect);
    EXPECT_FALSE(info_of(effect).what.empty()) << name_of(effect);
    EXPECT_NE(info_of(effect).called_for, nullptr) << name_of(effect);
  }
}

TEST(EffectPlan, PicturesOfAutoAndAllAreTheSame) {
  const auto scheduler = make_tbb_scheduler(2);
  const auto renderer = make_renderer("soft", *scheduler);
  for (const int samples : {1, 4}) {
    std::vector<Image> pictures;
    for (const Wish& wish : wishes()) {
      TwoModels models;
      wish.apply(models.scene);
      const Drawn planned = draw(models, *renderer, samples);
      models.scene.effects.kind = EffectRequest::Kind::all;
      const Drawn forced = draw(models, *renderer, samples);
      EXPECT_TRUE(planned.image.rgba == forced.image.rgba) << wish.name;
      EXPECT_TRUE(planned.image.depth == forced.image.depth) << wish.name;
      for (const Image& other : pictures) EXPECT_FALSE(planned.image.rgba == other.rgba) << wish.name;
      pictures.push_back(planned.image);
    }
  }
}

// On gl as well: what a program has no use for does not make another one of it.
TEST(EffectPlan, PicturesOfAutoAndAllAreTheSameOnGl) {
  const auto scheduler = make_serial_scheduler();
  std::string why;
  const auto renderer = renderer_if_possible("gl", *scheduler, why);
  if (!renderer) GTEST_SKIP() << why;
  for (const Wish& wish : wishes()) {
    TwoModels models;
    wish.apply(models.scene);
    const Image planned = draw(models, *renderer).image;
    models.scene.effects.kind = EffectRequest::Kind::all;
    EXPECT_TRUE(planned.rgba == draw(models, *renderer).image.rgba) << wish.name;
  }
}

// An effect that is named is seen, though the scene gives it no strength.
TEST(EffectPlan, EffectsThatAreNamedAreSeen) {
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  const auto drawn_with = [&](const std::string& names) {
    TwoModels models;
    models.scene.effects = parse_effects(names);
    return draw(models, *renderer).image.rgba;
  };
  const std::string usual = "geomorph,smooth-normals,head-light";
  std::vector<std::vector<std::uint8_t>> pictures{drawn_with(usual)};
  for (const char* name : {"level-tint", "wireframe", "overdraw", "ambient-occlusion", "fog", "directional-light",
                           "directional-light,shadow"}) {
    pictures.push_back(drawn_with(usual + "," + name));
    for (std::size_t k = 0; k + 1 < pictures.size(); ++k) EXPECT_FALSE(pictures[k] == pictures.back()) << name;
  }
}

TEST(EffectPlan, LengthsFollowFromTheSizeOfTheScene) {
  FrameSettings open;
  open.fog.density = by_scene_size;
  open.ambient_occlusion = {0.5f, by_scene_size};
  const FrameSettings small = complete_settings(open, {}, 1), large = complete_settings(open, {}, 100);
  EXPECT_GT(small.fog.density, 0);
  EXPECT_FLOAT_EQ(large.fog.density, small.fog.density / 100);
  EXPECT_FLOAT_EQ(large.ambient_occlusion.radius, 100 * small.ambient_occlusion.radius);
  EXPECT_EQ(large.ambient_occlusion.strength, 0.5f);
  // Given values are kept; `all` adds nothing.
  FrameSettings given;
  given.wireframe = 0.3f;
  EXPECT_EQ(complete_settings(given, parse_effects("wireframe"), 1), given);
  EXPECT_EQ(complete_settings({}, parse_effects("all"), 1), FrameSettings{});
  EXPECT_EQ(complete_settings({}, parse_effects("auto"), 1), FrameSettings{});
}

// The count of a pass, if an effect is one; else the points that it shades.
std::string work_of(Effect effect) {
  switch (effect) {
    case Effect::shadow:
      return "shadow triangles";
    case Effect::ambient_occlusion:
      return "occlusion pixels";
    case Effect::overdraw:
      return "covered samples";
    default:
      return std::string(name_of(effect));
  }
}

TEST(EffectPlan, WhatIsNotCalledForDoesNoWork) {
  const auto scheduler = make_tbb_scheduler(2);
  const auto renderer = make_renderer("soft", *scheduler);
  for (const Wish& wish : wishes()) {
    TwoModels models;
    wish.apply(models.scene);
    const Drawn drawn = draw(models, *renderer);
    for (const PlannedEffect& planned : explain_plan(drawn.frame)) {
      EXPECT_EQ(planned.runs, planned.called_for) << wish.name << " " << name_of(planned.effect);
      const bool worked = drawn.stats.work.contains(work_of(planned.effect));
      EXPECT_EQ(worked, planned.runs) << wish.name << " " << name_of(planned.effect);
    }
  }
}

TEST(EffectPlan, PlansEachModelByItself) {
  TwoModels models;
  models.scene.models[0].appearance.smooth = false;
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  const Frame frame = draw(models, *renderer).frame;
  EXPECT_FALSE(frame.models[0].effects.contains(Effect::smooth_normals));
  EXPECT_TRUE(frame.models[1].effects.contains(Effect::smooth_normals));
  const std::string text = to_text(explain_plan(frame), {"torus", "hills"});
  EXPECT_NE(text.find("smooth-normals      runs  a light falls on a smooth surface (hills)"), std::string::npos)
      << text;
  EXPECT_NE(text.find("fog                 -     not called for"), std::string::npos) << text;
}

TEST(EffectPlan, ListsAreTakenAtTheirWord) {
  TwoModels models;
  models.scene.effects = parse_effects("fog,head-light,texture");
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  const Drawn drawn = draw(models, *renderer);
  for (const ModelFrame& model : drawn.frame.models)
    EXPECT_EQ(model.effects, (EffectSet{Effect::head_light, Effect::fog, Effect::texture}));
  EXPECT_EQ(drawn.stats.work.size(), 3u);
  const std::string text = to_text(explain_plan(drawn.frame), {"torus", "hills"});
  EXPECT_NE(text.find("fog                 runs  the scene has fog"), std::string::npos) << text;  // of usual density
  EXPECT_NE(text.find("texture             runs  asked for, though nothing calls for it"), std::string::npos) << text;
  EXPECT_NE(text.find("smooth-normals      -     left out, though called for"), std::string::npos) << text;
}

TEST(EffectPlan, BackendsAgree) {
  const auto scheduler = make_tbb_scheduler(2);
  const auto soft = make_renderer("soft", *scheduler);
  std::string why;
  const auto gl = renderer_if_possible("gl", *scheduler, why);
  if (!gl) GTEST_SKIP() << why;
  for (const int samples : {1, 4})
    for (const Wish& wish : wishes()) {
      SCOPED_TRACE(wish.name);
      TwoModels models;
      wish.apply(models.scene);
      test::expect_conformance(draw(models, *gl, samples).image, draw(models, *soft, samples).image);
      models.scene.effects.kind = EffectRequest::Kind::all;
      test::expect_conformance(draw(models, *gl, samples).image, draw(models, *soft, samples).image);
    }
}

}  // namespace
}  // namespace lodestone
