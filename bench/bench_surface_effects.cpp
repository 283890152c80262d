// Cost of colours, textures and normal maps of a surface: the same frame with an effect and without it, in turn, so
// that whatever else the machine does falls on both alike.
//
// Arguments: backend (0: soft, 1: gl), effect, kappa0 in thousandths (a large one: nothing morphs). A terrain of
// 300,000 triangles fills most of 1280x720; its four textures of 1024 x 1024, repeated, come in bands. Counters:
// milliseconds a frame without the effect and what it adds to them, of processor time and wall time; points it shaded,
// and nanoseconds of processor time for each.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <memory>

#include "core/base/error.h"
#include "core/mesh/generate.h"
#include "core/texture/image_codec.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"
#include "render/frame/appearance.h"

namespace lodestone {
namespace {

constexpr std::array effects{Effect::vertex_colours, Effect::texture, Effect::normal_map};

Texture picture(std::uint32_t number) {
  constexpr std::uint32_t side = 1024;
  PixelImage image{.size = {side, side}, .channels = 3, .pixels = {}};
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      for (const std::uint32_t c : {x * (number + 1), y ^ x, 200 + y % 50})
        image.pixels.push_back(static_cast<std::uint8_t>(c));
  return {"picture", "image/png", TextureWrap::repeat, TextureWrap::mirror, encode_image(image, "image/png")};
}

// Every vertex is a wedge, and seams are where materials meet.
Hierarchy textured_terrain(Scheduler& scheduler) {
  RawMesh raw = generate_mesh({Shape::terrain, 300'000, 1});
  for (const Triangle& t : raw.triangles) {
    const auto material = static_cast<std::uint32_t>(std::fmin(std::fmax(4 * raw.positions[t.v[0]].y, 0), 3));
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p = raw.positions[t.v[k]];
      corners.v[k] = static_cast<std::uint32_t>(raw.wedges.uv.size());
      raw.wedges.uv.push_back({static_cast<float>(3 * p.x), static_cast<float>(3 * p.y)});
      const auto byte = [](double v) { return static_cast<std::uint8_t>(std::lround(200 * std::fabs(std::sin(v)))); };
      raw.wedges.colour.push_back({byte(9 * p.x), byte(7 * p.y), byte(99 * p.z), 255});
    }
    raw.wedges.corners.push_back(corners);
    raw.wedges.material.push_back(material);
  }
  for (std::uint32_t m = 0; m < 4; ++m) {
    raw.textures.push_back(picture(m));
    raw.materials.push_back({"material " + std::to_string(m), {1, 1, 1, 1}, m, (m + 1) % 4});
  }
  Repairs repairs;
  return build_hierarchy(prepare_mesh(std::move(raw), repairs, scheduler), {}, scheduler);
}

// A frame and what it refers to.
struct Scene {
  std::unique_ptr<Scheduler> scheduler = make_tbb_scheduler();
  Hierarchy hierarchy = textured_terrain(*scheduler);
  Radii radii;
  Selection selection;
  Frame frame;

  void look_from_above(float kappa0) {
    const auto at = [&](Vec3d p) { return hierarchy.transform.origin + hierarchy.transform.scale * p; };
    const Camera camera{at({0.5, 0.3, 1.2}), at({0.5, 0.5, 0.1}), {0, 1, 0}, 0.785};
    RadiiConfig config;
    config.kappa0 = kappa0;
    radii = make_radii(hierarchy, config);
    frame.only().morph = {&hierarchy, &radii, Blend::smoothstep, viewpoint(camera, hierarchy.transform)};
    frame.size = {1280, 720};
    frame.only().view_projection = view_projection(camera, hierarchy, frame.size);
    const Frustum frustum = frustum_of(frame.only().view_projection);
    select_cells(hierarchy, radii, frame.only().morph.viewpoint, {&frustum, false}, selection);
    frame.only().selection = &selection;
    frame.only().appearance = appearance_of(hierarchy);
  }
};

void BM_Effect(benchmark::State& state) {
  static Scene scene;
  scene.look_from_above(static_cast<float>(state.range(2)) / 1000);
  const Effect effect = effects.at(static_cast<std::size_t>(state.range(1)));
  const char* backend = state.range(0) == 0 ? "soft" : "gl";
  std::unique_ptr<Renderer> renderer;
  try {
    renderer = make_renderer(backend, *scene.scheduler);
  } catch (const UnsupportedError& error) {
    state.SkipWithError(error.what());
    return;
  }
  renderer->upload(scene.hierarchy);
  Frame with = scene.frame, without = scene.frame;
  with.only().effects.insert(effect);
  std::array<double, 2> wall{}, cpu{};
  FrameStats stats;
  const auto draw = [&](const Frame& frame, std::size_t which) {
    const CpuClock clock;
    stats = renderer->draw(frame);
    const StageTime time = clock.elapsed();
    wall[which] += time.seconds, cpu[which] += time.cpu_seconds;
  };
  draw(without, 0), draw(with, 1);  // uploads, decodes, compiles
  wall = cpu = {};
  for (auto _ : state) draw(without, 0), draw(with, 1);
  const double frames = 1e-3 * static_cast<double>(state.iterations());
  const auto points = static_cast<double>(stats.work[std::string(name_of(effect))]);
  state.SetLabel(std::string(backend) + " " + std::string(name_of(effect)));
  state.counters["ms"] = wall[0] / frames;
  state.counters["added_ms"] = (wall[1] - wall[0]) / frames;
  state.counters["cpu_ms"] = cpu[0] / frames;
  state.counters["added_cpu_ms"] = (cpu[1] - cpu[0]) / frames;
  if (points > 0) state.counters["points"] = points;
  if (points > 0) state.counters["ns_per_point"] = (cpu[1] - cpu[0]) / frames * 1e6 / points;
}
BENCHMARK(BM_Effect)
    ->ArgsProduct({{0, 1}, {0, 1, 2}, {12'000, 1'000'000'000}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(20);

}  // namespace
}  // namespace lodestone
