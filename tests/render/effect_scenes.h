// Frames of several models with effects, put together without the planner: what tests of the passes draw.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "render/camera/light_view.h"
#include "tests/render/conformance.h"

namespace lodestone::test {

// A model, scaled and moved into the world.
struct PlacedModel {
  std::shared_ptr<const Hierarchy> hierarchy;
  Vec3d offset;
  double scale = 1;
  Appearance appearance;
  float kappa0 = 2.5f;
  [[nodiscard]] ModelPlacement placement() const {
    return {scale, 0, 0, offset.x, 0, scale, 0, offset.y, 0, 0, scale, offset.z};
  }
};

struct EffectScene {
  std::string name;
  std::vector<PlacedModel> models;
  Vec3d eye, target;
  FrameSettings settings;
  EffectSet of_models{Effect::geomorph, Effect::smooth_normals, Effect::head_light};
  EffectSet of_picture;
  ImageSize size{320, 240};
  int samples = 1;
  Vec3d towards_light{0.3, -0.5, 0.8};
  double near = 0.1, far = 8;
};

namespace detail {

using Matrix = std::array<double, 16>;  // row-major

inline Vec3d unit(Vec3d v) { return (1 / length(v)) * v; }

// A pinhole of 45 degrees, and where a model is placed before it.
inline ViewProjection projection_of(const EffectScene& scene, const ModelPlacement& placement) {
  const Vec3d back = unit(scene.eye - scene.target), right = unit(cross(Vec3d{0, 0, 1}, back)), up = cross(back, right);
  const double tan_half = std::tan(0.785398163397448 / 2),
               aspect = static_cast<double>(scene.size.width) / scene.size.height;
  const double n = scene.near, f = scene.far;
  const auto row = [&](Vec3d axis, double scale) {
    return std::array<double, 4>{scale * axis.x, scale * axis.y, scale * axis.z, -scale * dot(axis, scene.eye)};
  };
  std::array<std::array<double, 4>, 4> clip{row(right, 1 / (tan_half * aspect)), row(up, 1 / tan_half),
                                            row(back, -(f + n) / (f - n)), row(back, -1)};
  clip[2][3] -= 2 * f * n / (f - n);
  ViewProjection vp;
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = 0; c < 4; ++c) {
      double sum = c == 3 ? clip[r][3] : 0;
      for (std::size_t k = 0; k < 3; ++k) sum += clip[r][k] * placement[4 * k + c];
      vp.m[4 * r + c] = static_cast<float>(sum);
    }
  return vp;
}

}  // namespace detail

// A frame of a scene, and what it refers to.
struct EffectFrame {
  std::deque<Radii> radii;
  std::deque<Selection> selections;
  std::vector<const Hierarchy*> hierarchies;
  LightView light;
  Frame frame;

  explicit EffectFrame(const EffectScene& scene) {
    frame.models.clear();
    frame.settings = scene.settings;
    frame.effects = scene.of_picture;
    frame.size = scene.size;
    frame.samples = scene.samples;
    const double tan_half = std::tan(0.785398163397448 / 2);
    frame.lens = {static_cast<float>(tan_half * scene.size.width / scene.size.height), static_cast<float>(tan_half),
                  static_cast<float>(scene.near), static_cast<float>(scene.far)};
    std::vector<Vec3d> corners;
    for (const PlacedModel& m : scene.models) {
      const auto box = corners_of(m.hierarchy->cells.front().bounds, m.placement());
      corners.insert(corners.end(), box.begin(), box.end());
    }
    light = fit_light(scene.towards_light, corners, corners, scene.settings.lighting.directional.shadow_texels);
    for (const PlacedModel& m : scene.models) add(scene, m);
  }
  EffectFrame(const EffectFrame&) = delete;
  EffectFrame& operator=(const EffectFrame&) = delete;

 private:
  void add(const EffectScene& scene, const PlacedModel& placed) {
    const Hierarchy& hierarchy = *placed.hierarchy;
    ModelFrame m;
    const auto known = std::ranges::find(hierarchies, &hierarchy);
    m.model = static_cast<std::uint32_t>(known - hierarchies.begin());
    if (known == hierarchies.end()) hierarchies.push_back(&hierarchy);
    radii.push_back(make_radii(hierarchy, detail::kappa0(placed.kappa0)));
    const Vec3f viewpoint = to_float((1 / placed.scale) * (scene.eye - placed.offset));
    m.morph = {&hierarchy, &radii.back(), Blend::smoothstep, viewpoint};
    m.view_projection = detail::projection_of(scene, placed.placement());
    m.light_projection = light_projection(light, placed.placement());
    const Frustum frustum = frustum_of(m.view_projection);
    for (const Frustum* culling : {&frustum, static_cast<const Frustum*>(nullptr)}) {
      selections.emplace_back();
      select_cells(hierarchy, radii.back(), viewpoint, {culling, true}, selections.back());
      (culling ? m.selection : m.casters) = &selections.back();
    }
    m.towards_eye = to_float(detail::unit(scene.eye - scene.target));
    m.towards_light = to_float(detail::unit(scene.towards_light));
    m.appearance = placed.appearance;
    m.effects = scene.of_models;
    frame.models.push_back(m);
  }
};

// Uploads first.
inline DrawnScene draw_effects(const EffectScene& scene, Renderer& renderer) {
  const EffectFrame made(scene);
  renderer.upload(made.hierarchies);
  DrawnScene drawn;
  drawn.stats = renderer.draw(made.frame);
  drawn.image = renderer.read_back();
  return drawn;
}

namespace detail {

// Two models over a third, lit from the side; all of them morph.
inline EffectScene still_life(const std::string& name) {
  static const auto torus = shared(torus_mesh(96, 48), 3);
  static const auto sphere = shared(sphere_mesh(4), 2);
  static const auto terrain = shared(terrain_mesh(64), 3);
  EffectScene scene;
  scene.name = name;
  Appearance red, green, grey;
  red.base_colour = {0.85f, 0.4f, 0.35f};
  green.base_colour = {0.45f, 0.75f, 0.45f};
  green.smooth = false;
  scene.models = {{terrain, {-1, -1, -0.35}, 2, grey},
                  {torus, {-0.55, -0.5, 0.15}, 0.8, red},
                  {sphere, {0.1, 0.0, 0.0}, 0.6, green}};
  scene.eye = {0.9, -2.2, 1.3};
  scene.target = {0, 0, 0.1};
  scene.settings.lighting.head = 0.3f;
  scene.settings.lighting.directional.strength = 0.8f;
  return scene;
}

// A shadow, then glass in front of it, and everything at once.
inline void add_transparent_scenes(std::vector<EffectScene>& scenes) {
  EffectScene shaded = still_life("shadow");
  shaded.of_models.insert(Effect::directional_light);
  shaded.of_picture.insert(Effect::shadow);
  shaded.settings.lighting.directional.shadows = true;
  shaded.settings.lighting.directional.shadow_texels = 1024;
  scenes.push_back(shaded);
  EffectScene glass = shaded;
  glass.name = "transparency";
  glass.of_picture.insert(Effect::transparency);
  glass.models[1].appearance.opacity = 0.4f;
  glass.models[2].appearance.opacity = 0.7f;
  glass.models[2].offset = {-0.3, -0.5, 0.05};  // through the torus
  scenes.push_back(glass);
  EffectScene all_glass = glass;  // with fog and edges, all of it
  all_glass.name = "transparency_all";
  all_glass.models[0].appearance.opacity = 0.5f;
  for (const Effect effect : {Effect::fog, Effect::wireframe}) all_glass.of_models.insert(effect);
  all_glass.settings.fog.density = 0.25f;
  all_glass.settings.wireframe = 0.4f;
  scenes.push_back(all_glass);
  EffectScene everything = all_glass;
  everything.name = "everything";
  everything.models[0].appearance.opacity = 1;
  everything.of_picture.insert(Effect::ambient_occlusion);
  everything.settings.ambient_occlusion = {0.8f, 0.25f};
  scenes.push_back(everything);
}

}  // namespace detail

inline std::vector<EffectScene> effect_scenes() {
  std::vector<EffectScene> scenes;
  EffectScene lit = detail::still_life("directional");
  lit.of_models.insert(Effect::directional_light);
  scenes.push_back(lit);
  lit.name = "directional_behind";
  lit.towards_light = {0.2, 0.9, 0.4};
  scenes.push_back(lit);
  EffectScene wires = detail::still_life("wireframe");
  wires.of_models.insert(Effect::directional_light);
  wires.of_models.insert(Effect::wireframe);
  wires.settings.wireframe = 0.8f;
  for (PlacedModel& m : wires.models) m.kappa0 = 1.2f;
  scenes.push_back(wires);
  EffectScene near = wires;  // the terrain passes under the camera
  near.name = "wireframe_near_plane";
  near.eye = {-0.4, -0.9, 0.05};
  near.target = {0.3, 0.6, 0.0};
  near.near = 0.3;
  near.of_models.insert(Effect::fog);
  near.settings.fog.density = 0.3f;
  scenes.push_back(near);
  EffectScene count = detail::still_life("overdraw");
  count.of_picture.insert(Effect::overdraw);
  count.settings.overdraw = true;
  scenes.push_back(count);
  detail::add_transparent_scenes(scenes);
  EffectScene dark = detail::still_life("occlusion");
  dark.of_picture.insert(Effect::ambient_occlusion);
  dark.settings.lighting.ambient = 1;
  dark.settings.ambient_occlusion = {1, 0.2f};
  dark.models[1].offset.z = 0;
  scenes.push_back(dark);
  add_multisampled(scenes, {"directional", "wireframe", "wireframe_near_plane", "overdraw", "shadow", "transparency",
                            "transparency_all", "occlusion", "everything"});
  return scenes;
}

}  // namespace lodestone::test
