// Masked, blended, single-sided, emissive and unlit materials: backends agree with each other and with rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/mesh/uv_map.h"
#include "core/texture/colour.h"
#include "render/backends/make_renderer.h"
#include "render/backends/soft/soft_renderer.h"
#include "render/frame/appearance.h"
#include "tests/render/rays.h"
#include "tests/render/textured_models.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

// The textured torus with other materials on its bands, in turn: 0 to 3, and none on the last.
std::shared_ptr<const Hierarchy> torus_of(const std::vector<Material>& materials, bool coloured = false) {
  static const auto plain = textured_torus(), with_colours = textured_torus(true);
  auto model = std::make_shared<Hierarchy>(*(coloured ? with_colours : plain));
  model->materials = materials;
  model->textures.push_back(as_texture("lace", lace({64, 64})));
  model->textures.push_back(as_texture("glow", painted({32, 32}, [](float u, float v) {
                                         return Vec3f{u > 0.5f ? 1.0f : 0.0f, v, 0.3f};
                                       })));
  return model;
}
constexpr std::uint32_t motley_texture = 0, bumps_texture = 3, lace_texture = 5, glow_texture = 6;

Material masked() { return {.name = "masked", .texture = lace_texture, .alpha_mode = AlphaMode::mask}; }
Material blended() {
  return {
      .name = "blended", .base_colour = {1, 0.7f, 0.7f, 0.8f}, .texture = lace_texture, .alpha_mode = AlphaMode::blend};
}
Material one_sided() { return {.name = "one sided", .base_colour = {0.2f, 0.5f, 0.9f, 1}, .double_sided = false}; }
Material glowing() {
  return {.name = "glowing",
          .base_colour = {0.05f, 0.05f, 0.05f, 1},
          .normal_map = bumps_texture,
          .normal_scale = 0.4f,
          .occlusion = {glow_texture, {}},
          .occlusion_strength = 0.8f,
          .emissive = {0.9f, 0.6f, 0.1f},
          .emissive_map = {glow_texture, {}},
          .double_sided = false,
          .extensions = R"({"KHR_materials_emissive_strength":{"emissiveStrength":0.7}})"};
}
Material unlit() { return {.name = "unlit", .texture = motley_texture, .unlit = true}; }

// Every map at a place of its own, with a base colour that has none.
constexpr UvTransform elsewhere{{0.3f, -0.2f}, {1.7f, -2.2f}, 0.6f};
Material moved() {
  Material m = glowing();
  m.texture = motley_texture;
  m.normal_transform = elsewhere;
  m.occlusion.transform = {{0.5f, 0}, {2, 2}, 0};
  m.emissive_map.transform = {{0, 0.25f}, {3, 1}, -1.2f};
  return m;
}

std::vector<TexturedScene> material_scenes() {
  static const auto lacy = torus_of({masked(), blended(), one_sided(), glowing()}),
                    flat = torus_of({unlit(), one_sided(), blended(), masked()}),
                    coloured = torus_of({masked(), blended(), unlit(), glowing()}, true),
                    sided = torus_of({one_sided(), one_sided(), glowing(), masked()}),
                    opaque = torus_of({unlit(), glowing(), unlit(), glowing()}),
                    places = torus_of({moved(), glowing(), moved(), masked()});
  const Appearance own = appearance_of(*lacy);
  Appearance glass = own;
  glass.opacity = 0.6f;
  const Vec3f apart{0.45f, 0.6f, 0.15f};
  std::vector<TexturedScene> scenes;
  scenes.push_back({"lacy", {{lacy, {}, own}}});
  scenes.push_back({"flat", {{flat, {}, own}}});
  scenes.push_back({"coloured", {{coloured, {}, own}}});
  scenes.push_back({"sided", {{sided, {}, own}}});
  scenes.push_back({"opaque", {{opaque, {}, own}}});
  scenes.push_back({"places", {{places, {}, own}}});
  scenes.push_back({"glass", {{lacy, {}, glass}}});
  scenes.push_back({"together", {{lacy, {}, own}, {coloured, apart, glass}, {textured_torus(), -1.0f * apart, own}}});
  TexturedScene inside{"near_plane", {{sided, {}, own}}};
  inside.eye = {0.12, 0.5, 0.13}, inside.target = {0.2, 0.9, 0.2};
  scenes.push_back(inside);
  TexturedScene wires{"wires", {{lacy, {}, own}}};
  wires.settings.wireframe = 0.5f;
  scenes.push_back(wires);
  add_multisampled(scenes, {"lacy", "together", "sided"});
  return scenes;
}

class MaterialScenes : public ::testing::TestWithParam<std::size_t> {
 protected:
  static const TexturedScene& scene() {
    static const std::vector<TexturedScene> scenes = material_scenes();
    return scenes[GetParam()];
  }
  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
};

TEST_P(MaterialScenes, GlAgreesWithSoft) {
  std::string why;
  const auto gl = renderer_if_possible("gl", *scheduler_, why);
  if (!gl) GTEST_SKIP() << why;
  TexturedFrame frame(scene());
  const Image image = frame.draw(*gl);
  const FrameStats of_gl = frame.stats;
  const Image reference = frame.draw(*make_renderer("soft", *scheduler_));
  keep_picture("materials_" + scene().name + "_gl", image);
  keep_picture("materials_" + scene().name + "_soft", reference);
  expect_conformance(image, reference);
  EXPECT_EQ(of_gl.cells, frame.stats.cells);
  EXPECT_EQ(of_gl.triangles, frame.stats.triangles);
}

TEST_P(MaterialScenes, AllEffectsGiveThePictureOfThoseCalledFor) {
  TexturedFrame planned(scene()), all(scene(), {EffectRequest::Kind::all, {}, {}});
  const auto soft = make_renderer("soft", *scheduler_);
  const Image image = planned.draw(*soft);
  EXPECT_TRUE(image.rgba == all.draw(*soft).rgba);
}

TEST_P(MaterialScenes, SameBytesForAllThreadsAndInstructionSets) {
  TexturedFrame frame(scene());
  const Image reference = frame.draw(*make_soft_renderer(*scheduler_, {InstructionSet::plain}));
  const auto threads = make_tbb_scheduler(3);
  const Image image = frame.draw(*make_soft_renderer(*threads));
  EXPECT_TRUE(image.rgba == reference.rgba);
  EXPECT_TRUE(image.depth == reference.depth);
}

INSTANTIATE_TEST_SUITE_P(All, MaterialScenes, ::testing::Range(std::size_t{0}, material_scenes().size()),
                         [](const auto& instance) { return material_scenes()[instance.param].name; });

// Colours and alphas alone, so that a ray knows what it sees.
EffectScene plain_scene(std::vector<Material> materials) {
  EffectScene scene;
  scene.size = {80, 60};
  Appearance white;
  white.base_colour = {1, 1, 1};
  scene.models = {{torus_of(materials), {-0.5, -0.5, -0.15}, 1, white}};
  scene.eye = {0.3, -1.0, 0.6};
  scene.target = {0, 0, 0};
  scene.settings.lighting.ambient = 1;
  scene.of_models = {Effect::geomorph, Effect::texture};
  scene.of_picture = {Effect::transparency};
  return scene;
}

// The wrong pixels of a picture whose colours a ray finds by colour_of(triangle, alpha), and the depth that it keeps.
void expect_what_rays_see(const EffectScene& scene) {
  const std::vector<WorldTriangle> triangles = drawn_triangles(scene);
  const auto scheduler = make_serial_scheduler();
  const Image image = draw_effects(scene, *make_soft_renderer(*scheduler)).image;
  int wrong = 0, not_drawn = 0, blended = 0, depths = 0;
  for (int y = 0; y < scene.size.height; ++y)
    for (int x = 0; x < scene.size.width; ++x) {
      Vec3d light;
      double through = 1, opaque_at = 0;
      for (const auto& [at, t] : hits_of(scene, triangles, x, y)) {
        static const Material none;
        const Material& m = t->material ? *t->material : none;
        const Vec3d normal = cross(t->v[1] - t->v[0], t->v[2] - t->v[0]);
        const bool away = dot(normal, ray(scene, x, y)) > 0;
        const double alpha = m.base_colour[3];
        if ((away && !m.double_sided) || (m.alpha_mode == AlphaMode::mask && alpha < double{m.alpha_cutoff})) {
          ++not_drawn;
          continue;
        }
        const bool veil = m.alpha_mode == AlphaMode::blend;
        blended += veil;
        const double share = veil ? alpha : 1;
        const auto channel = [&](std::size_t c) { return linear_to_srgb(m.base_colour[c]); };
        light = light + (through * share) * Vec3d{channel(0), channel(1), channel(2)};
        through *= 1 - share;
        if (veil) continue;
        opaque_at = at;
        break;
      }
      light = light + through * to_double(scene.settings.background);
      const std::size_t pixel = static_cast<std::size_t>(y * scene.size.width + x);
      const std::uint8_t* rgba = &image.rgba[4 * pixel];
      wrong += std::abs(rgba[0] - 255 * light.x) > 2 || std::abs(rgba[1] - 255 * light.y) > 2 ||
               std::abs(rgba[2] - 255 * light.z) > 2;
      const double n = scene.near, f = scene.far, z = n * f / (f - image.depth[pixel] * (f - n));
      depths += opaque_at == 0 ? image.depth[pixel] != 1 : std::abs(z - opaque_at) > 0.02;
    }
  const int allowed = scene.size.width * scene.size.height / 100;  // along edges
  EXPECT_GT(not_drawn, 300);
  EXPECT_GT(blended, 300);
  EXPECT_LE(wrong, allowed);
  EXPECT_LE(depths, allowed);
}

Material plain(AlphaMode mode, std::array<float, 4> colour, bool double_sided) {
  return {.name = {}, .base_colour = colour, .alpha_mode = mode, .double_sided = double_sided};
}

TEST(Materials, AreThoseOfRays) {
  using enum AlphaMode;
  const Material clear = plain(mask, {1, 0, 0, 0.49f}, true), solid = plain(mask, {0.2f, 0.8f, 0.3f, 0.5f}, true),
                 veil = plain(blend, {0.9f, 0.4f, 0.1f, 0.3f}, true),
                 backless_veil = plain(blend, {0.3f, 0.1f, 0.9f, 0.6f}, false),
                 backless = plain(opaque, {0.8f, 0.8f, 0.1f, 0.2f}, false),
                 backless_solid = plain(mask, {0.8f, 0.3f, 0.5f, 0.7f}, false);
  expect_what_rays_see(plain_scene({clear, veil, solid, backless}));
  expect_what_rays_see(plain_scene({backless_veil, clear, veil, backless_solid}));
  EffectScene inside = plain_scene({backless, veil, clear, backless_solid});
  inside.eye = {-0.35, -0.2, 0.0};  // within the tube: triangles pass the near plane
  inside.target = {-0.3, 0.2, 0.05};
  inside.near = 0.05;
  expect_what_rays_see(inside);
}

// Without the effect, or with the model's materials off, alpha is not looked at.
TEST(Materials, AreOpaqueWhereNothingAsksForAlpha) {
  const auto scheduler = make_serial_scheduler();
  const auto soft = make_soft_renderer(*scheduler);
  const auto of = [&](AlphaMode mode, EffectSet of_picture) {
    EffectScene scene = plain_scene(std::vector<Material>(4, plain(mode, {0.3f, 0.6f, 0.2f, 0.2f}, true)));
    scene.of_picture = of_picture;
    return draw_effects(scene, *soft).image.rgba;
  };
  const auto opaque = of(AlphaMode::opaque, {});
  EXPECT_TRUE(opaque == of(AlphaMode::opaque, {Effect::transparency}));
  EXPECT_TRUE(opaque == of(AlphaMode::mask, {}));
  EXPECT_TRUE(opaque == of(AlphaMode::blend, {}));
  EXPECT_FALSE(opaque == of(AlphaMode::blend, {Effect::transparency}));
}

// The colour of a pixel on the band of a material, in the encoding of the picture.
Vec3d colour_drawn(const Material& material, const Lighting& lighting) {
  EffectScene scene = plain_scene(std::vector<Material>(5, material));
  scene.settings.lighting = lighting;
  scene.of_models = EffectSet::all();
  scene.of_models.erase(Effect::shadow);
  scene.eye = {0.0, -0.9, 0.3};
  scene.target = {0, -0.4, 0};
  const auto scheduler = make_serial_scheduler();
  const Image image = draw_effects(scene, *make_soft_renderer(*scheduler)).image;
  Vec3d most;
  for (std::size_t p = 0; p < image.depth.size(); ++p)
    if (image.depth[p] < 1)
      most = {std::max(most.x, static_cast<double>(image.rgba[4 * p])),
              std::max(most.y, static_cast<double>(image.rgba[4 * p + 1])),
              std::max(most.z, static_cast<double>(image.rgba[4 * p + 2]))};
  return most;
}

TEST(Materials, GiveOffTheirLightAndNoMore) {
  Lighting dark;
  dark.ambient = dark.head = 0;
  Material m{.name = {}, .base_colour = {1, 1, 1, 1}, .emissive = {0.5f, 0.25f, 0}};
  const auto byte = [](double linear) { return 255 * std::min(linear_to_srgb(linear), 1.0); };
  Vec3d c = colour_drawn(m, dark);
  EXPECT_NEAR(c.x, byte(0.5), 1);
  EXPECT_NEAR(c.y, byte(0.25), 1);
  EXPECT_EQ(c.z, 0);
  m.extensions = R"({"KHR_materials_emissive_strength":{"emissiveStrength":2.0}})";
  c = colour_drawn(m, dark);
  EXPECT_EQ(c.x, 255);
  EXPECT_NEAR(c.y, byte(0.5), 1);
  m.unlit = true;  // shows its base colour, without emission
  m.base_colour = {0.25f, 0.5f, 0.125f, 1};
  c = colour_drawn(m, dark);
  EXPECT_NEAR(c.x, byte(0.25), 1);
  EXPECT_NEAR(c.y, byte(0.5), 1);
  EXPECT_NEAR(c.z, byte(0.125), 1);
}

// The occlusion's strength is a share of the ambient light.
TEST(Materials, OcclusionTakesAmbientLightAlone) {
  Lighting ambient;
  ambient.ambient = 0.5f;
  ambient.head = 0;
  Material m{.name = {}, .base_colour = {1, 1, 1, 1}};
  const double open = colour_drawn(m, ambient).x;
  m.occlusion = {2, {}};  // "stripes", red 0 or 1
  m.occlusion_strength = 0;
  EXPECT_NEAR(colour_drawn(m, ambient).x, open, 1);
  const auto flat = [&](float strength) {
    auto scene = plain_scene({});
    auto model = std::make_shared<Hierarchy>(*scene.models[0].hierarchy);
    model->textures = {as_texture("grey", painted({4, 4}, [](float, float) { return Vec3f{0.4f, 1, 1}; }))};
    m.occlusion = {0, {}};
    m.occlusion_strength = strength;
    model->materials = std::vector<Material>(4, m);
    scene.models[0].hierarchy = model;
    scene.settings.lighting = ambient;
    scene.of_models.insert(Effect::occlusion_map);
    const auto scheduler = make_serial_scheduler();
    const Image image = draw_effects(scene, *make_soft_renderer(*scheduler)).image;
    int least = 255;
    for (std::size_t p = 0; p < image.depth.size(); ++p)
      if (image.depth[p] < 1) least = std::min(least, int{image.rgba[4 * p]});
    return least;
  };
  EXPECT_NEAR(flat(1), 0.4 * 127.5, 2);
  EXPECT_NEAR(flat(0.5f), 0.7 * 127.5, 2);
}

// Maps at a place of their own are those of a mesh whose coordinates are there.
TEST(Materials, MapsLieWhereTheirTransformsPutThem) {
  Material m = glowing();
  const auto model = torus_of({m, m, m, m});
  m.normal_transform = m.occlusion.transform = m.emissive_map.transform = elsewhere;
  const auto placed = torus_of({m, m, m, m});
  auto mapped = std::make_shared<Hierarchy>(*model);
  std::vector<std::vector<Vec2f>> uv;
  const auto [a, b, c, d, x, y] = map_of(elsewhere);
  for (Cell& cell : mapped->cells) {
    for (std::vector<Vec2f>& own = uv.emplace_back(); const Vec2f t : cell.attributes.uv)
      own.push_back({static_cast<float>(a * t.x + b * t.y + x), static_cast<float>(c * t.x + d * t.y + y)});
    cell.attributes.uv = uv.back();
  }
  const auto scheduler = make_serial_scheduler();
  const auto soft = make_soft_renderer(*scheduler);
  const auto draw = [&](const std::shared_ptr<const Hierarchy>& of) {
    return TexturedFrame({"", {{of, {}, appearance_of(*of)}}}).draw(*soft).rgba;
  };
  const auto picture = draw(placed), expected = draw(mapped);
  const auto far = [](const auto& p, const auto& q) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < p.size(); ++k) count += std::abs(int{p[k]} - int{q[k]}) > 2;
    return count;
  };
  EXPECT_LE(far(picture, expected), picture.size() / 1000) << "rounding, where a texture has edges";
  EXPECT_GT(far(picture, draw(model)), picture.size() / 20) << "the places matter";
}

}  // namespace
}  // namespace lodestone
