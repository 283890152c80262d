// Cost of each effect, on `soft` and `gl`: a frame with it against one without, in turn.
//
// A terrain of half a million triangles that morphs, 1280x720, one and four samples a pixel. Counters: milliseconds of
// processor time (all threads) a frame with the effect, and how many of them are the effect's. Where there is no OpenGL
// the benchmarks of gl are skipped with the reason.
#include <benchmark/benchmark.h>

#include <functional>
#include <memory>
#include <string>

#include "core/base/error.h"
#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"
#include "render/camera/light_view.h"

namespace lodestone {
namespace {

const Hierarchy& terrain(Scheduler& scheduler) {
  static const Hierarchy hierarchy = [&] {
    Repairs repairs;
    return build_hierarchy(prepare_mesh(generate_mesh({Shape::terrain, 500'000, 1}), repairs, scheduler), {},
                           scheduler);
  }();
  return hierarchy;
}

// A frame and what it refers to, with head light and smooth normals.
struct View {
  Radii radii;
  Selection selection, casters;
  Frame frame;

  View(const Hierarchy& hierarchy, int samples) {
    RadiiConfig config;
    config.kappa0 = 12;
    radii = make_radii(hierarchy, config);
    const auto at = [&](Vec3d p) { return hierarchy.transform.origin + hierarchy.transform.scale * p; };
    const Camera camera{at({0.5, -0.3, 0.8}), at({0.5, 0.4, 0.1}), {0, 0, 1}, 0.785};
    frame.size = {1280, 720};
    frame.samples = samples;
    ModelFrame& model = frame.only();
    model.morph = {&hierarchy, &radii, Blend::smoothstep, viewpoint(camera, hierarchy.transform)};
    model.view_projection = view_projection(camera, hierarchy, frame.size);
    const Frustum frustum = frustum_of(model.view_projection);
    select_cells(hierarchy, radii, model.morph.viewpoint, {&frustum, false}, selection);
    select_cells(hierarchy, radii, model.morph.viewpoint, {}, casters);
    model.selection = &selection;
    model.casters = &casters;
    const auto corners = corners_of(hierarchy.cells.front().bounds, no_placement);
    const Vec3d towards_light{0.5, 0.3, 0.4};
    const LightView light =
        fit_light(towards_light, corners, corners, frame.settings.lighting.directional.shadow_texels);
    model.light_projection = light_projection(light, no_placement);
    model.towards_light = to_float(light.towards_light);
    frame.lens = {0.736f, 0.414f, 0.15f, 2};
  }
  View(const View&) = delete;
  View& operator=(const View&) = delete;
};

struct Case {
  const char* name;
  void (*switch_on)(Frame& frame);
};

void light(Frame& frame) {
  frame.only().effects.insert(Effect::directional_light);
  frame.settings.lighting.directional.strength = 0.7f;
}

constexpr Case cases[]{
    {"directional_light", light},
    {"wireframe",
     [](Frame& frame) {
       frame.only().effects.insert(Effect::wireframe);
       frame.settings.wireframe = 0.5f;
     }},
    {"overdraw",
     [](Frame& frame) {
       frame.effects.insert(Effect::overdraw);
       frame.settings.overdraw = true;
     }},
    {"light_and_shadow",
     [](Frame& frame) {
       light(frame);
       frame.effects.insert(Effect::shadow);
       frame.settings.lighting.directional.shadows = true;
     }},
    {"transparency",
     [](Frame& frame) {
       frame.effects.insert(Effect::transparency);
       frame.only().appearance.opacity = 0.5f;
     }},
    {"ambient_occlusion",
     [](Frame& frame) {
       frame.effects.insert(Effect::ambient_occlusion);
       frame.settings.ambient_occlusion = {0.8f, 0.05f};
     }},
};

double cpu_seconds(Renderer& renderer, const Frame& frame) {
  const CpuClock clock;
  renderer.draw(frame);
  return clock.elapsed().cpu_seconds;
}

void draw(benchmark::State& state, const char* backend, const Case& effect) {
  const auto scheduler = make_tbb_scheduler();
  const Hierarchy& hierarchy = terrain(*scheduler);
  std::unique_ptr<Renderer> renderer;
  try {
    renderer = make_renderer(backend, *scheduler);
  } catch (const UnsupportedError& error) {
    state.SkipWithError(error.what());
    return;
  }
  const View view(hierarchy, static_cast<int>(state.range(0)));
  Frame with = view.frame;
  effect.switch_on(with);
  renderer->upload(hierarchy);
  renderer->draw(view.frame);
  renderer->draw(with);
  double plain = 0, own = 0;
  for (auto _ : state) {
    plain += cpu_seconds(*renderer, view.frame);
    own += cpu_seconds(*renderer, with);
  }
  const auto frames = static_cast<double>(state.iterations());
  state.counters["with_ms"] = own * 1e3 / frames;
  state.counters["effect_ms"] = (own - plain) * 1e3 / frames;
}

const bool registered = [] {
  for (const char* backend : {"soft", "gl"})
    for (const Case& effect : cases)
      benchmark::RegisterBenchmark((std::string(backend) + "/" + effect.name).c_str(),
                                   [=, &effect](benchmark::State& state) { draw(state, backend, effect); })
          ->Arg(1)
          ->Arg(4)
          ->Unit(benchmark::kMillisecond)
          ->Iterations(5);
  return true;
}();

}  // namespace
}  // namespace lodestone
