// Cost of comparing pictures: FLIP, SSIM, absolute difference, pops and leaks, of frames of 1280x720 pixels.
//
// One worker, so that times are those of a core. The pictures are two frames of a generated sphere and the full model;
// "everywhere": a picture against its negative, as pixels that agree with their surroundings cost next to nothing.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <memory>

#include "core/mesh/generate.h"
#include "experiments/metrics/cracks/leaks.h"
#include "experiments/metrics/cracks/t_junctions.h"
#include "experiments/metrics/pictures/image_quality.h"
#include "experiments/metrics/pictures/ssim.h"
#include "experiments/metrics/pops/image_pops.h"
#include "experiments/metrics/pops/step_visibility.h"
#include "experiments/systems/system_pictures.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"

namespace {

using namespace lodestone;

// Two frames of a path with their full model, and what was drawn.
struct Subject {
  Subject() {
    BuildConfig config;
    config.simplifier = "cluster";
    Repairs repairs;
    hierarchy = build_hierarchy(prepare_mesh(generate_mesh({Shape::sphere, 500'000, 1}), repairs, *all), config, *all);
    const auto renderer = make_renderer("soft", *all);
    Scene scene = scene_of("sphere");
    SceneView view(scene, {{&hierarchy}});
    SystemPictures pictures(view, *renderer, *all);
    const std::vector<Camera> path = orbit_path(view.bounding_sphere(), 200, {view.up(), 1});
    for (int i = 0; i < 2; ++i) {
      drawn[i] = pictures.draw("discrete", path[static_cast<std::size_t>(i)], view_config(scene, size));
      full[i] = pictures.draw("full", path[static_cast<std::size_t>(i)], view_config(scene, size));
      error[i] = absolute_error(full[i].image, drawn[i].image);
    }
    negative = full[0].image;
    for (std::uint8_t& value : negative.rgba) value = static_cast<std::uint8_t>(255 - value);
  }
  [[nodiscard]] ErrorFrame frame(int i) const {
    return {{&error[i]}, &full[i].image, full[i].models.front().view_projection};
  }

  ImageSize size{1280, 720};
  std::unique_ptr<Scheduler> all = make_tbb_scheduler(), one = make_serial_scheduler();
  Hierarchy hierarchy;
  SystemPicture drawn[2], full[2];
  ErrorMap error[2];
  Image negative;  // differs from the first full picture in every pixel
};

Subject& subject() {
  static Subject only;
  return only;
}

template <class Measure>
void measure(benchmark::State& state, const Measure& body) {
  const Subject& s = subject();
  for (auto _ : state) benchmark::DoNotOptimize(body(s));
}

void flip(benchmark::State& state) {
  measure(state, [](const Subject& s) { return flip_error(s.full[0].image, s.drawn[0].image, *s.one); });
}
void flip_everywhere(benchmark::State& state) {
  measure(state, [](const Subject& s) { return flip_error(s.full[0].image, s.negative, *s.one); });
}
void structural_similarity_everywhere(benchmark::State& state) {
  measure(state, [](const Subject& s) { return ssim(s.full[0].image, s.negative, *s.one); });
}
void structural_similarity(benchmark::State& state) {
  measure(state, [](const Subject& s) { return ssim(s.full[0].image, s.drawn[0].image, *s.one); });
}
void absolute(benchmark::State& state) {
  measure(state, [](const Subject& s) { return absolute_error(s.full[0].image, s.drawn[0].image); });
}
void picture_pops(benchmark::State& state) {
  measure(state, [](const Subject& s) { return change_maps(s.frame(0), s.frame(1), *s.one); });
}
void visible_steps(benchmark::State& state) {
  measure(state, [](const Subject& s) { return step_visibility(s.error[0].value, s.size, *s.one); });
}
void leaks(benchmark::State& state) {
  measure(state, [](const Subject& s) {
    const SystemModel& model = s.drawn[0].models.front();
    return find_leaks(model.context(), model.whole, {model.view_projection, s.size}, *s.one,
                      {.full_depth = s.full[0].image.depth});
  });
}
void junctions(benchmark::State& state) {
  measure(state, [](const Subject& s) {
    const SystemModel& model = s.drawn[0].models.front();
    return t_junctions(model.context(), model.whole, 1e-4, *s.one);
  });
}

BENCHMARK(absolute)->Unit(benchmark::kMillisecond);
BENCHMARK(structural_similarity)->Unit(benchmark::kMillisecond);
BENCHMARK(flip)->Unit(benchmark::kMillisecond);
BENCHMARK(flip_everywhere)->Unit(benchmark::kMillisecond);
BENCHMARK(structural_similarity_everywhere)->Unit(benchmark::kMillisecond);
BENCHMARK(picture_pops)->Unit(benchmark::kMillisecond);
BENCHMARK(visible_steps)->Unit(benchmark::kMillisecond);
BENCHMARK(leaks)->Unit(benchmark::kMillisecond);
BENCHMARK(junctions)->Unit(benchmark::kMillisecond);

}  // namespace
