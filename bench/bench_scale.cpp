// Cost of a larger model: the same flight over a generated surface of a million triangles and over one of N, each
// frame drawn of both in turn, so that whatever else the machine does falls on both alike.
//
// Arguments: N in millions, tolerance in pixels, whether hidden cells are left out. Counters: processor milliseconds
// (all threads) a frame of either, selection included, their ratio, and the triangles drawn a frame.
#include <benchmark/benchmark.h>

#include <map>
#include <memory>

#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"

namespace lodestone {
namespace {

constexpr ImageSize size{1280, 720};

// Built once each; a model of 56 million takes 2 GB and half a minute.
const Hierarchy& model(Shape shape, std::int64_t millions, Scheduler& scheduler) {
  static std::map<std::pair<Shape, std::int64_t>, Hierarchy> models;
  const auto [entry, fresh] = models.try_emplace({shape, millions});
  if (fresh) {
    Repairs repairs;
    const GenerateConfig config{shape, static_cast<std::uint64_t>(millions) * 1'000'000, 1};
    entry->second = build_hierarchy(prepare_mesh(generate_mesh(config), repairs, scheduler), {}, scheduler);
  }
  return entry->second;
}

// A model on its flight, and what its frames have taken.
struct Contender {
  const Hierarchy& hierarchy;
  std::unique_ptr<Renderer> renderer;
  double cpu = 0;  // seconds
  std::uint64_t triangles = 0;

  Contender(const Hierarchy& h, Scheduler& scheduler) : hierarchy(h), renderer(make_renderer("soft", scheduler)) {
    renderer->upload(h);
  }

  void draw(const Camera& camera, float pixels, bool cull_occluded) {
    const CpuClock clock;
    RadiiConfig config;
    config.pixel_error = pixels;
    config.vertical_fov = static_cast<float>(camera.vertical_fov);
    const Radii radii = make_radii(hierarchy, config);
    Frame frame;
    frame.size = size;
    frame.cull_occluded = cull_occluded;
    ModelFrame& drawn = frame.only();
    drawn.morph = {&hierarchy, &radii, Blend::smoothstep, viewpoint(camera, hierarchy.transform)};
    drawn.view_projection = view_projection(camera, hierarchy, size);
    const Frustum frustum = frustum_of(drawn.view_projection);
    Selection selection;
    select_cells(hierarchy, radii, drawn.morph.viewpoint, {&frustum, false}, selection);
    drawn.selection = &selection;
    triangles += renderer->draw(frame).triangles;
    cpu += clock.elapsed().cpu_seconds;
  }
};

void fly(benchmark::State& state, Shape shape, bool orbit) {
  const auto scheduler = make_tbb_scheduler();
  Contender small(model(shape, 1, *scheduler), *scheduler), large(model(shape, state.range(0), *scheduler), *scheduler);
  // Cameras of the small model's path: the models fill the same box but for their finest detail.
  const std::vector<Camera> path = orbit ? orbit_path(small.hierarchy, 24) : fly_in_path(small.hierarchy, 24);
  const auto pixels = static_cast<float>(state.range(1));
  for (auto _ : state)
    for (const Camera& camera : path)
      for (Contender* c : {&small, &large}) c->draw(camera, pixels, state.range(2) != 0);
  const auto frames = static_cast<double>(state.iterations()) * static_cast<double>(path.size());
  state.counters["small_cpu_ms"] = small.cpu * 1e3 / frames;
  state.counters["large_cpu_ms"] = large.cpu * 1e3 / frames;
  state.counters["times"] = large.cpu / small.cpu;
  state.counters["small_triangles"] = static_cast<double>(small.triangles) / frames;
  state.counters["large_triangles"] = static_cast<double>(large.triangles) / frames;
}

void BM_SphereOrbit(benchmark::State& state) { fly(state, Shape::sphere, true); }
void BM_SphereFlyIn(benchmark::State& state) { fly(state, Shape::sphere, false); }
void BM_TerrainOrbit(benchmark::State& state) { fly(state, Shape::terrain, true); }
void BM_TerrainFlyIn(benchmark::State& state) { fly(state, Shape::terrain, false); }

void settings(benchmark::internal::Benchmark* b) {
  b->Unit(benchmark::kMillisecond)->Iterations(2)->ArgsProduct({{4, 16, 56}, {1, 4}, {0, 1}});
}

BENCHMARK(BM_SphereOrbit)->Apply(settings);
BENCHMARK(BM_SphereFlyIn)->Apply(settings);
BENCHMARK(BM_TerrainOrbit)->Apply(settings);
BENCHMARK(BM_TerrainFlyIn)->Apply(settings);

}  // namespace
}  // namespace lodestone
