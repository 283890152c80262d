// The software backend and selection: a generated sphere close up, so that about a million triangles are drawn.
//
// Argument: triangles of the input. Counters: drawn triangles, and milliseconds of each stage of the last frame.
#include <benchmark/benchmark.h>

#include <memory>

#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"

namespace lodestone {
namespace {

struct Scene {
  std::unique_ptr<Scheduler> scheduler = make_tbb_scheduler();
  Hierarchy hierarchy;
  Radii radii;
  Selection selection;
  Frustum frustum;
  Frame frame;

  // kappa0 large: everything at the finest level, as at one pixel on a screen of many; the sphere fills the picture.
  Scene(std::uint64_t triangles, float kappa0) {
    Repairs repairs;
    hierarchy = build_hierarchy(prepare_mesh(generate_mesh({Shape::sphere, triangles, 1}), repairs, *scheduler), {},
                                *scheduler);
    RadiiConfig config;
    config.kappa0 = kappa0;
    radii = make_radii(hierarchy, config);
    const Camera camera = orbit_path(hierarchy, 8)[1];
    frame.only().morph = {&hierarchy, &radii, Blend::smoothstep, viewpoint(camera, hierarchy.transform)};
    frame.size = {1280, 720};
    frame.only().view_projection = view_projection(camera, hierarchy, frame.size);
    frustum = frustum_of(frame.only().view_projection);
    select();
    frame.only().selection = &selection;
  }
  void select() { select_cells(hierarchy, radii, frame.only().morph.viewpoint, {&frustum, false}, selection); }
};

Scene& scene(std::int64_t triangles, float kappa0) {
  static std::map<std::pair<std::int64_t, float>, std::unique_ptr<Scene>> scenes;
  auto& entry = scenes[{triangles, kappa0}];
  if (!entry) entry = std::make_unique<Scene>(static_cast<std::uint64_t>(triangles), kappa0);
  return *entry;
}

void draw(benchmark::State& state, float kappa0) {
  Scene& s = scene(state.range(0), kappa0);
  const auto renderer = make_renderer("soft", *s.scheduler);
  renderer->upload(s.hierarchy);
  FrameStats stats;
  for (auto _ : state) stats = renderer->draw(s.frame);
  state.counters["triangles"] = static_cast<double>(stats.triangles);
  for (const auto& [stage, milliseconds] : stats.milliseconds) state.counters[stage] = milliseconds;
}

void BM_DrawFinest(benchmark::State& state) { draw(state, 1e6f); }
void BM_DrawMorphing(benchmark::State& state) { draw(state, 12); }

void BM_Select(benchmark::State& state) {
  Scene& s = scene(state.range(0), 12);
  for (auto _ : state) s.select();
  state.counters["cells"] = static_cast<double>(s.selection.cells.size());
  state.counters["visited"] = s.selection.visited;
}

BENCHMARK(BM_DrawFinest)->Arg(1'000'000)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(BM_DrawMorphing)->Arg(1'000'000)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(BM_Select)->Arg(1'000'000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace lodestone
