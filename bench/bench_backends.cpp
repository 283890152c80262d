// The backends side by side: `soft` and `gl` draw the same frame in turn, so that whatever else the machine does falls
// on both alike.
//
// Arguments: triangles of the generated surface, all of them drawn and inside the picture of 1280x720, and samples a
// pixel; of the terrain none is hidden. Counters: milliseconds of wall and of processor time (all threads) a frame, and
// how many times the frame rate of gl soft has, by either. Where there is no OpenGL the benchmark is skipped with the
// reason.
#include <benchmark/benchmark.h>

#include <map>
#include <memory>

#include "core/base/error.h"
#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"

namespace lodestone {
namespace {

// kappa0 decides how much of the model morphs: with `finest` every cell is static.
constexpr float finest = 1e6f;

// Built once each.
const Hierarchy& model(Shape shape, std::int64_t triangles, Scheduler& scheduler) {
  static std::map<std::pair<Shape, std::int64_t>, Hierarchy> models;
  const auto [entry, fresh] = models.try_emplace({shape, triangles});
  if (fresh) {
    Repairs repairs;
    const GenerateConfig config{shape, static_cast<std::uint64_t>(triangles), 1};
    entry->second = build_hierarchy(prepare_mesh(generate_mesh(config), repairs, scheduler), {}, scheduler);
  }
  return entry->second;
}

// A frame and what it refers to.
struct View {
  const Hierarchy& hierarchy;
  Radii radii;
  Selection selection;
  Frame frame;

  View(const Hierarchy& h, const Camera& camera, float kappa0, int samples) : hierarchy(h) {
    RadiiConfig config;
    config.kappa0 = kappa0;
    radii = make_radii(hierarchy, config);
    frame.only().morph = {&hierarchy, &radii, Blend::smoothstep, viewpoint(camera, hierarchy.transform)};
    frame.size = {1280, 720};
    frame.samples = samples;
    frame.only().view_projection = view_projection(camera, hierarchy, frame.size);
    const Frustum frustum = frustum_of(frame.only().view_projection);
    select_cells(hierarchy, radii, frame.only().morph.viewpoint, {&frustum, false}, selection);
    frame.only().selection = &selection;
  }
  View(const View&) = delete;
  View& operator=(const View&) = delete;
};

// The terrain from above: nothing hidden, and as high as the picture. Other shapes on their orbit.
Camera camera_for(Shape shape, const Hierarchy& hierarchy) {
  if (shape != Shape::terrain) return orbit_path(hierarchy, 8)[1];
  const auto at = [&](Vec3d p) { return hierarchy.transform.origin + hierarchy.transform.scale * p; };
  return {at({0.5, 0.49, 1.36}), at({0.5, 0.5, 0.1}), {0, 1, 0}, 0.785};
}

// A backend and what its frames have taken.
struct Contender {
  std::unique_ptr<Renderer> renderer;
  double wall = 0, cpu = 0;  // seconds
  FrameStats stats;

  void draw(const Frame& frame) {
    const CpuClock clock;
    stats = renderer->draw(frame);
    const StageTime time = clock.elapsed();
    wall += time.seconds;
    cpu += time.cpu_seconds;
  }
};

void draw_both(benchmark::State& state, Shape shape, float kappa0) {
  const auto scheduler = make_tbb_scheduler();
  const Hierarchy& hierarchy = model(shape, state.range(0), *scheduler);
  const View view(hierarchy, camera_for(shape, hierarchy), kappa0, static_cast<int>(state.range(1)));
  Contender soft, gl;
  soft.renderer = make_renderer("soft", *scheduler);
  try {
    gl.renderer = make_renderer("gl", *scheduler);
  } catch (const UnsupportedError& error) {
    state.SkipWithError(error.what());
    return;
  }
  for (Contender* c : {&soft, &gl}) {
    c->renderer->upload(hierarchy);
    c->draw(view.frame);
    c->wall = c->cpu = 0;
  }
  for (auto _ : state) {
    soft.draw(view.frame);
    gl.draw(view.frame);
  }
  const auto frames = static_cast<double>(state.iterations());
  state.counters["triangles"] = static_cast<double>(soft.stats.triangles);
  for (const auto& [name, c] : {std::pair{"soft", &soft}, std::pair{"gl", &gl}}) {
    state.counters[std::string(name) + "_ms"] = c->wall * 1e3 / frames;
    state.counters[std::string(name) + "_cpu_ms"] = c->cpu * 1e3 / frames;
  }
  state.counters["times_wall"] = gl.wall / soft.wall;
  state.counters["times_cpu"] = gl.cpu / soft.cpu;
}

void BM_Terrain(benchmark::State& state) { draw_both(state, Shape::terrain, finest); }
void BM_Sphere(benchmark::State& state) { draw_both(state, Shape::sphere, finest); }
void BM_Morphing(benchmark::State& state) { draw_both(state, Shape::terrain, 12); }

void settings(benchmark::internal::Benchmark* b) { b->Unit(benchmark::kMillisecond)->Iterations(5); }

BENCHMARK(BM_Terrain)->Args({1'000'000, 1})->Args({4'000'000, 1})->Args({1'000'000, 4})->Apply(settings);
BENCHMARK(BM_Sphere)->Args({1'000'000, 1})->Args({4'000'000, 1})->Args({100'000, 1})->Apply(settings);
BENCHMARK(BM_Morphing)->Args({1'000'000, 1})->Args({4'000'000, 1})->Apply(settings);

}  // namespace
}  // namespace lodestone
