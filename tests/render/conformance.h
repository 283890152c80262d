// The conformance suite: scenes that every backend draws, and how far its pictures may be from those of `soft`.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "parallel/scheduler.h"
#include "render/lod/radii.h"
#include "render/renderer.h"
#include "tests/render/small_hierarchy.h"

namespace lodestone::testing {

// Backends differ where rounding moves an edge or the order of two nearly equal depths by a pixel, and nowhere else.
struct ConformanceTolerance {
  int threshold = 8;               // a pixel differs when a channel differs by more than this, of 255
  double differing_share = 0.005;  // of the pixels
  double mean_absolute = 0.5;      // over all channels, of 255
};

struct ConformanceScene {
  std::string name;
  std::shared_ptr<const Hierarchy> hierarchy;
  Camera camera;  // normalised space is model space in these scenes
  RadiiConfig radii;
  Blend blend = Blend::smoothstep;
  ImageSize size{320, 240};
  bool tint_by_level = false;
};

namespace detail {

inline std::shared_ptr<const Hierarchy> shared(IndexedMesh mesh, int finest, float sigma0 = 0.5f) {
  auto small = std::make_shared<SmallHierarchy>(small_hierarchy(std::move(mesh), finest, sigma0));
  return {small, &small->hierarchy};
}

inline RadiiConfig kappa0(float value, RadiiRule rule = RadiiRule::per_level) {
  RadiiConfig config;
  config.rule = rule;
  config.kappa0 = value;
  return config;
}

}  // namespace detail

inline std::vector<ConformanceScene> conformance_scenes() {
  using detail::kappa0;
  static const auto bumpy_torus = detail::shared(torus(96, 48), 3);
  static const auto terrain = detail::shared(hills(64), 3);
  static const auto sphere = detail::shared(ball(24), 2);
  static const auto one_cell = detail::shared(ball(4), 0);
  const Camera outside{{0.4, -0.55, 1.0}, {0.5, 0.5, 0.5}};
  const Camera low_over_hills{{0.1, 0.1, 0.36}, {0.8, 0.7, 0.2}, {0, 0, 1}, 1.2};
  std::vector<ConformanceScene> scenes;
  scenes.push_back({"finest", bumpy_torus, outside, kappa0(1000)});
  scenes.push_back({"coarse", bumpy_torus, outside, kappa0(0.01f)});
  scenes.push_back({"morphing", bumpy_torus, outside, kappa0(2.5f)});
  scenes.push_back({"tinted", bumpy_torus, {{0.2, 0.1, 0.75}, {0.6, 0.5, 0.5}}, kappa0(2), Blend::linear, {}, true});
  scenes.back().size = {317, 241};  // no multiple of anything
  scenes.push_back({"near_plane", terrain, low_over_hills, kappa0(2), Blend::cosine});
  scenes.push_back({"inside", sphere, {{0.5, 0.5, 0.5}, {1, 0.7, 0.6}}, kappa0(2), Blend::smootherstep});
  scenes.push_back({"step_inadmissible", bumpy_torus, outside, kappa0(0.8f, RadiiRule::uniform), Blend::step});
  scenes.push_back({"looking_away", sphere, {{0.5, -1, 0.5}, {0.5, -2, 0.5}}, kappa0(2)});
  scenes.push_back({"root_only", one_cell, {{0.5, -1, 0.5}, {0.5, 0.5, 0.5}}, kappa0(2)});
  scenes.push_back({"straight_down", terrain, {{0.5, 0.5, 2}, {0.5, 0.5, 0}}, kappa0(3)});
  scenes.push_back({"one_pixel", sphere, outside, kappa0(2)});
  scenes.back().size = {1, 1};
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
  frame.morph = {&hierarchy, &radii, scene.blend, viewpoint(scene.camera, hierarchy.transform)};
  frame.view_projection = view_projection(scene.camera, hierarchy, scene.size);
  frame.size = scene.size;
  frame.tint_by_level = scene.tint_by_level;
  const Vec3d towards_eye = scene.camera.position - scene.camera.target;
  frame.light = to_float((1 / length(towards_eye)) * towards_eye);
  const Frustum frustum = frustum_of(frame.view_projection);
  Selection selection;
  select_cells(hierarchy, radii, frame.morph.viewpoint, {&frustum, false}, selection);
  frame.selection = &selection;
  renderer.upload(hierarchy);
  DrawnScene drawn;
  drawn.stats = renderer.draw(frame);
  drawn.image = renderer.read_back();
  return drawn;
}

// Null when the backend cannot run here; `why` says what is missing.
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
  const ImageDifference d = difference(image, reference, tolerance.threshold);
  // A pixel or two may always differ: in a tiny picture that is a large share.
  EXPECT_TRUE(d.differing_share <= tolerance.differing_share || d.differing <= 1)
      << d.differing << " pixels differ, the worst by " << d.max;
  EXPECT_TRUE(d.mean_absolute <= tolerance.mean_absolute || d.differing <= 1) << d.mean_absolute;
}

}  // namespace lodestone::testing
