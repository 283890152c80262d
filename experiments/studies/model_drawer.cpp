#include "experiments/studies/model_drawer.h"

#include "experiments/studies/rounds.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/make_renderer.h"

namespace lodestone {

ViewConfig view_of_model(ImageSize size, int samples) {
  ViewConfig config = view_config(scene_of("input"), size);
  config.samples = samples;
  return config;
}

ViewConfig at_full_detail(ViewConfig config) {
  config.radii.rule = RadiiRule::per_level;
  config.radii.kappa0 = 1e6f;  // nothing is so far away
  return config;
}

ModelDrawer::ModelDrawer(const Hierarchy& hierarchy, const ViewConfig& config, std::string_view backend,
                         Scheduler& scheduler)
    : config_(config), view_(scene_of("input"), {{&hierarchy}}), renderer_(make_renderer(backend, scheduler)) {
  view_.upload(*renderer_);
}

ModelDrawer::Drawn ModelDrawer::draw(const Camera& camera) {
  Drawn drawn;
  const CpuClock clock;
  view_.update(camera, config_);
  drawn.select_seconds = clock.elapsed().seconds;
  drawn.stats = view_.draw(*renderer_);
  drawn.time = clock.elapsed();
  return drawn;
}

FlightTimes time_flight(ModelDrawer& drawer, std::span<const Shot> shots, int rounds, const RunContext& context) {
  FlightTimes times;
  for (const Shot& shot : shots) (void)drawer.draw(shot.camera);
  const auto count = static_cast<double>(shots.size());
  for (int round = 0; round < rounds; ++round) {
    check_cancelled(context);
    std::vector<StageTime> frames;
    double select_seconds = 0;
    for (const Shot& shot : shots) {
      const ModelDrawer::Drawn drawn = drawer.draw(shot.camera);
      frames.push_back(drawn.time);
      select_seconds += drawn.select_seconds;
      times.triangles += static_cast<double>(drawn.stats.triangles);
      times.cells += static_cast<double>(drawn.stats.cells);
    }
    times.frames.add(frames);
    times.select_ms.push_back(1000 * select_seconds / count);
  }
  times.triangles /= count * rounds, times.cells /= count * rounds;
  return times;
}

}  // namespace lodestone
