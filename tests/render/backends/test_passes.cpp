// Passes against slow, obvious twins that cast rays: shadows, layers, overdraw.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/backends/gl/shaders/varyings.h"
#include "render/backends/soft/soft_renderer.h"
#include "render/frame/shading.h"
#include "tests/render/effect_scenes.h"
#include "tests/render/rays.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

DrawnScene draw_soft(const EffectScene& scene) {
  const auto scheduler = make_serial_scheduler();
  return draw_effects(scene, *make_soft_renderer(*scheduler));
}

EffectScene small(const std::string& name) {
  const auto all = effect_scenes();
  EffectScene scene = *std::ranges::find(all, name, &EffectScene::name);
  scene.size = {80, 60};
  return scene;
}

TEST(Shadows, AreThoseOfRays) {
  EffectScene scene = small("shadow");
  const std::vector<WorldTriangle> triangles = drawn_triangles(scene);
  const Image shaded = draw_soft(scene).image;
  EffectScene lit = scene, dark = scene;
  lit.of_picture = {};
  dark.settings.lighting.directional.strength = 0;
  const Image full = draw_soft(lit).image, none = draw_soft(dark).image;
  const Vec3d towards = detail::unit(scene.towards_light);
  int in_shadow = 0, in_light = 0, wrong = 0;
  for (int y = 0; y < scene.size.height; ++y)
    for (int x = 0; x < scene.size.width; ++x) {
      const std::size_t at = 4 * static_cast<std::size_t>(y * scene.size.width + x);
      const int light = full.rgba[at] - none.rgba[at];
      if (light < 25) continue;  // hardly lit anyway
      const Hits seen = hits_of(scene, triangles, x, y);
      if (seen.empty()) continue;
      const Vec3d point = scene.eye + seen.front().first * ray(scene, x, y);
      const bool hidden = std::ranges::any_of(triangles, [&](const WorldTriangle& t) {
        const auto way = hit(t, point, towards);
        return way && *way > 0.01;
      });
      const double share = static_cast<double>(full.rgba[at] - shaded.rgba[at]) / light;
      (hidden ? in_shadow : in_light) += 1;
      wrong += hidden ? share < 0.5 : share > 0.5;
    }
  EXPECT_GT(in_shadow, 50);
  EXPECT_GT(in_light, 500);
  EXPECT_LE(wrong, (in_shadow + in_light) / 50) << "of " << in_shadow << " and " << in_light;  // at their borders
}

// Glass holds back of the light what it does not let through, once for each of its surfaces on the way.
TEST(Shadows, OfLayersAreAsDarkAsTheseAreOpaque) {
  EffectScene scene = small("transparency");
  scene.models[1].appearance.opacity = 0.2f;
  scene.models[2].appearance.opacity = 0.45f;
  scene.size = {160, 120};
  const std::vector<WorldTriangle> triangles = drawn_triangles(scene);
  EffectScene lit = scene, dark = scene;
  lit.of_picture = {Effect::transparency};
  dark.settings.lighting.directional.strength = 0;
  const Image shaded = draw_soft(scene).image, full = draw_soft(lit).image, none = draw_soft(dark).image;
  const Vec3d towards = detail::unit(scene.towards_light);
  int in_shadow = 0, wrong = 0;
  for (int y = 0; y < scene.size.height; ++y)
    for (int x = 0; x < scene.size.width; ++x) {
      const std::size_t at = 4 * static_cast<std::size_t>(y * scene.size.width + x);
      const int light = full.rgba[at] - none.rgba[at];
      const Hits seen = hits_of(scene, triangles, x, y);
      if (light < 50 || seen.empty() || seen.front().second->model != 0) continue;  // ground alone, well lit
      const Vec3d point = scene.eye + seen.front().first * ray(scene, x, y);
      double through = 1;
      for (const WorldTriangle& t : triangles)
        if (const auto way = hit(t, point, towards); way && *way > 0.01)
          through *= 1 - scene.models[t.model].appearance.opacity;
      const double share = static_cast<double>(full.rgba[at] - shaded.rgba[at]) / light;
      in_shadow += through < 1;
      wrong += std::abs(share - (1 - through)) > 0.08;
    }
  EXPECT_GT(in_shadow, 200);
  EXPECT_LE(wrong, in_shadow / 5) << "of " << in_shadow;  // at their borders, which are blurred
}

// A plane in the light of any angle throws no shadow on itself.
TEST(Shadows, LeaveOpenGroundAlone) {
  for (const double height : {1.0, 0.3, 0.1, 0.03}) {
    EffectScene scene = small("shadow");
    IndexedMesh flat = terrain_mesh(16);
    for (Vec3f& p : flat.positions) p.z = 0.25f;
    scene.models = {{detail::shared(std::move(flat), 1), {-1, -1, -0.35}, 2, {}}};
    scene.towards_light = {0.7, 0.4, height};
    scene.settings.lighting.directional.strength = 5;  // a plane at a small angle gets little
    scene.settings.lighting.head = 0;
    const Image shaded = draw_soft(scene).image;
    scene.of_picture = {};
    EXPECT_TRUE(shaded.rgba == draw_soft(scene).image.rgba) << height;
  }
}

TEST(Shadows, TakeNoPassWithoutALightThatCastsThem) {
  const EffectScene scene = small("shadow");
  EXPECT_EQ(draw_soft(scene).stats.work.count("shadow triangles"), 1u);
  std::vector<EffectScene> without(3, scene);
  without[0].settings.lighting.directional.shadows = false;
  without[1].settings.lighting.ambient = 1;
  without[2].of_models.erase(Effect::directional_light);
  for (const EffectScene& s : without) {
    const FrameStats stats = draw_soft(s).stats;
    EXPECT_EQ(stats.work.count("shadow triangles"), 0u);
    EXPECT_EQ(stats.work.count("shadow"), 0u);
    EXPECT_EQ(stats.milliseconds.count("shadow"), 0u);
  }
}

// The same models throw a shadow, whether light goes through them or not.
TEST(Shadows, CountWhatIsOpaqueAndWhatIsNotOnBothBackends) {
  EffectScene glass = small("transparency"), opaque = glass;
  for (PlacedModel& model : opaque.models) model.appearance.opacity = 1;
  const auto scheduler = make_serial_scheduler();
  for (const std::string backend : {"soft", "gl"}) {
    std::string why;
    const auto renderer = renderer_if_possible(backend, *scheduler, why);
    if (!renderer) continue;
    const std::uint64_t counted = draw_effects(opaque, *renderer).stats.work.at("shadow triangles");
    EXPECT_GT(counted, 0u);
    EXPECT_EQ(draw_effects(glass, *renderer).stats.work.at("shadow triangles"), counted) << backend;
  }
}

TEST(Layers, AreThoseOfRaysInOrder) {
  EffectScene scene = small("transparency_all");
  scene.settings = {};
  scene.settings.lighting.ambient = 1;  // colours as they are
  scene.of_models = {Effect::geomorph};
  const std::vector<WorldTriangle> triangles = drawn_triangles(scene);
  const Image image = draw_soft(scene).image;
  int wrong = 0, deep = 0;
  for (int y = 0; y < scene.size.height; ++y)
    for (int x = 0; x < scene.size.width; ++x) {
      Vec3d light;
      double through = 1;
      const Hits hits = hits_of(scene, triangles, x, y);
      for (const auto& [depth, t] : hits) {
        const Appearance& appearance = scene.models[t->model].appearance;
        light = light + (through * appearance.opacity) * to_double(appearance.base_colour);
        through *= 1 - appearance.opacity;
      }
      light = light + through * to_double(scene.settings.background);
      deep += hits.size() >= 4;
      const std::uint8_t* pixel = &image.rgba[4 * static_cast<std::size_t>(y * scene.size.width + x)];
      wrong += std::abs(pixel[0] - 255 * light.x) > 2 || std::abs(pixel[1] - 255 * light.y) > 2 ||
               std::abs(pixel[2] - 255 * light.z) > 2;
    }
  EXPECT_GT(deep, 50);
  EXPECT_LE(wrong, scene.size.width * scene.size.height / 200);  // along edges, where snapping moves a pixel
}

// The order of the models in the frame is not the order of their layers.
TEST(Layers, DoNotDependOnTheOrderOfModels) {
  EffectScene scene = small("transparency_all");
  for (const int samples : {1, 4}) {
    scene.samples = samples;
    const Image image = draw_soft(scene).image;
    EffectScene turned = scene;
    std::ranges::reverse(turned.models);
    const ImageDifference d = image_difference(draw_soft(turned).image, image, 1);
    EXPECT_LE(d.differing, 2u);
  }
}

TEST(Layers, OfNoOpacityAreNotSeen) {
  EffectScene scene = small("transparency");
  EffectScene without = scene;
  without.models.resize(1);
  scene.models[1].appearance.opacity = scene.models[2].appearance.opacity = 0;
  for (EffectScene* s : {&scene, &without}) s->settings.lighting.directional.shadows = false;
  const ImageDifference d = image_difference(draw_soft(scene).image, draw_soft(without).image, 0);
  EXPECT_EQ(d.differing, 0u);
}

TEST(Overdraw, CountsWhatRaysHit) {
  const EffectScene scene = small("overdraw");
  const std::vector<WorldTriangle> triangles = drawn_triangles(scene);
  const DrawnScene drawn = draw_soft(scene);
  std::uint64_t sum = 0;
  int wrong = 0;
  for (int y = 0; y < scene.size.height; ++y)
    for (int x = 0; x < scene.size.width; ++x) {
      const auto count = static_cast<std::uint32_t>(hits_of(scene, triangles, x, y).size());
      sum += count;
      const Vec3f c = count ? shading::overdraw_colour(count) : scene.settings.background;
      const std::uint8_t* pixel = &drawn.image.rgba[4 * static_cast<std::size_t>(y * scene.size.width + x)];
      wrong +=
          pixel[0] != shading::to_byte(c.x) || pixel[1] != shading::to_byte(c.y) || pixel[2] != shading::to_byte(c.z);
    }
  EXPECT_LE(wrong, scene.size.width * scene.size.height / 100);
  EXPECT_NEAR(static_cast<double>(drawn.stats.work.at("covered samples")), static_cast<double>(sum),
              0.005 * static_cast<double>(sum));
}

TEST(Overdraw, CountsTheSameOnBothBackendsWhateverTheSamples) {
  std::string why;
  const auto scheduler = make_serial_scheduler();
  const auto gl = renderer_if_possible("gl", *scheduler, why);
  if (!gl) GTEST_SKIP() << why;
  for (const int samples : {1, 4}) {
    EffectScene scene = small("overdraw");
    scene.size = {320, 240};
    scene.samples = samples;
    const std::uint64_t soft = draw_soft(scene).stats.work.at("covered samples"),
                        other = draw_effects(scene, *gl).stats.work.at("covered samples");
    EXPECT_NEAR(static_cast<double>(other), static_cast<double>(soft), 2) << "rounding moves an edge, if anything";
  }
}

TEST(Occlusion, DarkensCreasesAndNothingElse) {
  EffectScene scene = small("occlusion");
  scene.size = {160, 120};
  IndexedMesh flat = terrain_mesh(16);
  for (Vec3f& p : flat.positions) p.z = 0.25f;
  scene.models = {{detail::shared(std::move(flat), 1), {-1, -1, -0.35}, 2, {}}, scene.models[2]};
  scene.models[1].offset = {-0.3, -0.3, -0.05};  // intersects the ground
  const Image image = draw_soft(scene).image;
  EffectScene open = scene;
  open.of_picture = {};
  const Image plain = draw_soft(open).image;
  int darker = 0, lighter = 0;
  for (std::size_t k = 0; k < image.rgba.size(); ++k) {
    darker += image.rgba[k] + 20 < plain.rgba[k];
    lighter += image.rgba[k] > plain.rgba[k];
  }
  EXPECT_GT(darker, 300);
  EXPECT_EQ(lighter, 0);
  // The ground by itself has no creases.
  scene.models.resize(1);
  open.models.resize(1);
  const ImageDifference d = image_difference(draw_soft(scene).image, draw_soft(open).image, 2);
  EXPECT_EQ(d.differing, 0u);
}

TEST(Varyings, AreFoundAndPassedOn) {
  const std::string source =
      "flat out vec3 tint;  // a hue\nlayout(location = 0) out vec4 colour;\ncentroid out vec3 normal;\n"
      "float out_of(float x);\n  out vec2 uv;\n";
  const std::vector<GlVarying> found = varyings_of(source, "out");
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0], (GlVarying{"flat ", "vec3", "tint"}));
  EXPECT_EQ(found[1], (GlVarying{"centroid ", "vec3", "normal"}));
  EXPECT_EQ(found[2], (GlVarying{"", "vec2", "uv"}));
  const std::string placed = with_locations(source, "out", found);
  EXPECT_NE(placed.find("layout(location = 1) centroid out vec3 normal;"), std::string::npos);
  EXPECT_EQ(placed.find("layout(location = 0) layout"), std::string::npos);
  const std::string stage = geometry_source(found, found, "", "");
  EXPECT_NE(stage.find("layout(location = 2) in vec2 from_uv[];"), std::string::npos);
  EXPECT_NE(stage.find("to_tint = from_tint[i];"), std::string::npos);
}

}  // namespace
}  // namespace lodestone
