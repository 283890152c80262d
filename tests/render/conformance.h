// The conformance suite: scenes that every backend draws, and how far its pictures may be from those of `soft`.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/scheduler/scheduler.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"
#include "render/lod/radii.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone::test {

// Backends differ where rounding moves an edge or the order of two nearly equal depths by a pixel, and nowhere else.
// Measured for gl on Mesa's llvmpipe: at most 0.027 % of the pixels by more than 8, and 0.004 on average.
struct ConformanceTolerance {
  int threshold = 8;               // a pixel differs when a channel differs by more than this, of 255
  double differing_share = 0.005;  // of the pixels
  double mean_absolute = 0.5;      // over all channels, of 255
  float depth = 1e-3f;             // a pixel's depth differs when it is farther off than this
};

struct ConformanceScene {
  std::string name;
  std::shared_ptr<const Hierarchy> hierarchy;
  Camera camera;  // normalised space is model space in these scenes
  RadiiConfig radii;
  Blend blend = Blend::smoothstep;
  ImageSize size{320, 240};
  bool tint_by_level = false;
  int samples = 1;
};

namespace detail {

inline std::shared_ptr<const Hierarchy> shared(IndexedMesh mesh, int finest, float sigma0 = 0.5f) {
  auto small = std::make_shared<NaiveHierarchy>(naive_hierarchy(std::move(mesh), finest, sigma0));
  return {small, &small->hierarchy};
}

// A hierarchy made by the real builder.
inline std::shared_ptr<const Hierarchy> built(Shape shape, std::uint64_t triangles) {
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  BuildConfig config;
  config.cell_triangles = 400;
  config.strategy = Strategy::serial;
  return std::make_shared<Hierarchy>(
      build_hierarchy(prepare_mesh(generate_mesh({shape, triangles, 1}), repairs, *scheduler), config, *scheduler));
}

inline RadiiConfig kappa0(float value, RadiiRule rule = RadiiRule::per_level) {
  RadiiConfig config;
  config.rule = rule;
  config.kappa0 = value;
  return config;
}

// Given in normalised space.
inline Camera camera(const Hierarchy& hierarchy, Vec3d position, Vec3d target, double vertical_fov = 0.785) {
  const auto to_model = [&](Vec3d p) { return hierarchy.transform.origin + hierarchy.transform.scale * p; };
  return {to_model(position), to_model(target), {0, 0, 1}, vertical_fov};
}

}  // namespace detail

// Adds the scenes of these names once more, with four samples per pixel.
template <class Scene>
void add_multisampled(std::vector<Scene>& scenes, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    Scene smooth = *std::ranges::find(scenes, name, &Scene::name);
    smooth.name += "_4x";
    smooth.samples = 4;
    scenes.push_back(std::move(smooth));
  }
}

inline std::vector<ConformanceScene> conformance_scenes() {
  using detail::camera, detail::kappa0;
  static const auto torus = detail::shared(torus_mesh(96, 48), 3);
  static const auto terrain = detail::shared(terrain_mesh(64), 3);
  static const auto sphere = detail::shared(sphere_mesh(4), 2);
  static const auto one_cell = detail::shared(sphere_mesh(1), 0);
  static const auto scan = detail::built(Shape::sphere, 20'000);
  const auto outside = [](const auto& h) { return camera(*h, {0.4, -0.55, 0.6}, {0.5, 0.5, 0.1}); };
  const Camera above_torus = camera(*torus, {0.2, 0.1, 0.45}, {0.6, 0.5, 0.1});
  const Camera low_over_hills = camera(*terrain, {0.1, 0.1, 0.22}, {0.8, 0.7, 0.05}, 1.2);
  const Camera above_hills = camera(*terrain, {0.5, 0.5, 1.6}, {0.5, 0.5, 0});  // along its up: another is chosen
  const Camera inside = camera(*sphere, {0.5, 0.5, 0.5}, {1, 0.7, 0.6});
  const Camera away = camera(*sphere, {0.5, -1, 0.5}, {0.5, -2, 0.5});
  std::vector<ConformanceScene> scenes;
  scenes.push_back({"finest", torus, outside(torus), kappa0(1000)});
  scenes.push_back({"coarse", torus, outside(torus), kappa0(0.01f)});
  scenes.push_back({"morphing", torus, outside(torus), kappa0(2.5f)});
  scenes.push_back({"tinted", torus, above_torus, kappa0(2), Blend::linear, {317, 241}, true});
  scenes.push_back({"near_plane", terrain, low_over_hills, kappa0(2), Blend::cosine});
  scenes.push_back({"inside", sphere, inside, kappa0(2), Blend::smootherstep});
  scenes.push_back({"step_inadmissible", torus, outside(torus), kappa0(0.8f, RadiiRule::uniform), Blend::step});
  scenes.push_back({"looking_away", sphere, away, kappa0(2)});
  scenes.push_back({"root_only", one_cell, outside(one_cell), kappa0(2)});
  scenes.push_back({"straight_down", terrain, above_hills, kappa0(3)});
  const Camera scan_view = camera(*scan, {0.3, -0.6, 0.9}, {0.5, 0.5, 0.5});
  scenes.push_back({"built", scan, scan_view, {}});  // at one pixel
  RadiiConfig adaptive;
  adaptive.rule = RadiiRule::adaptive;
  scenes.push_back({"adaptive", scan, scan_view, adaptive});
  adaptive.pixel_error = 8;
  scenes.push_back({"adaptive_coarse", torus, outside(torus), adaptive, Blend::linear, {320, 240}, true});
  scenes.push_back({"built_tinted", scan, scan_view, kappa0(0.9f), Blend::late, {320, 240}, true});
  scenes.push_back({"one_pixel", sphere, outside(sphere), kappa0(2), Blend::smoothstep, {1, 1}});
  add_multisampled(scenes, {"morphing", "adaptive", "near_plane", "inside", "built_tinted", "one_pixel"});
  return scenes;
}

struct DrawnScene {
  Image image;
  FrameStats stats;
};

// Selects and draws; uploads first.
inline DrawnScene draw_scene(const ConformanceScene& scene, Renderer& renderer) {
  const Hierarchy& hierarchy = *scene.hierarchy;
  const Radii radii = make_radii(hierarchy, scene.radii);
  Frame frame;
  frame.only().morph = {&hierarchy, &radii, scene.blend, viewpoint(scene.camera, hierarchy.transform)};
  frame.only().view_projection = view_projection(scene.camera, hierarchy, scene.size);
  frame.size = scene.size;
  frame.settings.level_tint = scene.tint_by_level ? 1.0f : 0.0f;
  frame.only().effects.set(Effect::level_tint, scene.tint_by_level);
  frame.samples = scene.samples;
  const Vec3d towards_eye = scene.camera.position - scene.camera.target;
  frame.only().towards_eye = to_float((1 / length(towards_eye)) * towards_eye);
  const Frustum frustum = frustum_of(frame.only().view_projection);
  Selection selection;
  select_cells(hierarchy, radii, frame.only().morph.viewpoint, {&frustum, false}, selection);
  frame.only().selection = &selection;
  renderer.upload(hierarchy);
  DrawnScene drawn;
  drawn.stats = renderer.draw(frame);
  drawn.image = renderer.read_back();
  return drawn;
}

// Null if the backend cannot run here; `why` then names what is missing.
inline std::unique_ptr<Renderer> renderer_if_possible(const std::string& backend, Scheduler& scheduler,
                                                      std::string& why) {
  try {
    return make_renderer(backend, scheduler);
  } catch (const UnsupportedError& error) {
    why = error.what();
    return nullptr;
  }
}

inline void expect_conformance(const Image& image, const Image& reference, const ConformanceTolerance& tolerance = {}) {
  ASSERT_EQ(image.size, reference.size);
  const ImageDifference d = image_difference(image, reference, tolerance.threshold);
  // A pixel or two may always differ: in a tiny picture that is a large share.
  EXPECT_TRUE(d.differing_share <= tolerance.differing_share || d.differing <= 1)
      << d.differing << " pixels differ, the worst by " << d.max;
  EXPECT_TRUE(d.mean_absolute <= tolerance.mean_absolute || d.differing <= 1) << d.mean_absolute;
  // Depth: the same where the same surface is seen.
  ASSERT_EQ(image.depth.size(), reference.depth.size());
  std::size_t elsewhere = 0;
  for (std::size_t i = 0; i < image.depth.size(); ++i)
    elsewhere += std::abs(image.depth[i] - reference.depth[i]) > tolerance.depth;
  EXPECT_LE(static_cast<double>(elsewhere),
            std::max(1.0, tolerance.differing_share * static_cast<double>(image.depth.size())));
}

// For inspection: with LODESTONE_PICTURES=DIR in the environment the pictures are written there.
inline void keep_picture(const std::string& name, const Image& image) {
  if (const char* folder = std::getenv("LODESTONE_PICTURES"))
    write_png(std::string(folder) + "/" + name + ".png", image);
}

}  // namespace lodestone::test
