#include "experiments/flights/flight.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/base/error.h"
#include "experiments/metrics/cost/order_statistics.h"
#include "experiments/metrics/cracks/cracks.h"
#include "experiments/metrics/drawn/screen_error.h"
#include "experiments/metrics/pops/jump_tracker.h"
#include "parallel/scheduler/clock.h"
#include "render/lod/selection.h"

namespace lodestone {
namespace {

// What measuring a frame needs to remember from the one before.
class Prover {
 public:
  // `limit_rate`: of the detail limits of a streamed hierarchy, which is measured on the whole one.
  Prover(const Hierarchy& hierarchy, double limit_rate, Scheduler& scheduler)
      : hierarchy_(hierarchy),
        limit_rate_(limit_rate),
        scheduler_(scheduler),
        basis_(make_crack_basis(hierarchy, scheduler)) {}

  void measure(MorphContext morph, FrameRow& row) {
    morph.hierarchy = &hierarchy_;
    Selection whole;
    select_cells(hierarchy_, *morph.radii, morph.viewpoint, {.limits = morph.limits}, whole);
    for (const SelectedCell& s : whole.cells) row.selected_triangles += hierarchy_.cells[s.cell].triangles.size();
    row.open_edges += residual_edges(morph, whole, basis_, scheduler_, crack_scratch_).open_edges;
    row.gap_max = std::max(row.gap_max, double{vertex_gaps(morph, whole, basis_, scheduler_, crack_scratch_).gap_max});
    if (const auto jumps = jumps_.follow(morph, std::move(whole), scheduler_, {.limit_rate = limit_rate_})) {
      row.max_jump = std::max(row.max_jump, jumps->max_jump);
      row.jump_over_bound = std::max(row.jump_over_bound, jumps->jump_over_bound);
    }
  }

 private:
  const Hierarchy& hierarchy_;
  double limit_rate_;
  Scheduler& scheduler_;
  CrackBasis basis_;
  CrackScratch crack_scratch_;
  JumpTracker jumps_;
};

// Of the surface in the frame, drawn or culled, from the full one.
double measured_screen_error(const ModelFrame& model, ImageSize size, const Hierarchy& whole,
                             const ScreenErrorBasis& basis, Scheduler& scheduler) {
  MorphContext morph = model.morph;
  morph.hierarchy = &whole;
  Selection all;
  select_cells(whole, *morph.radii, morph.viewpoint, {.limits = morph.limits}, all);
  return screen_error(morph, all, model.view_projection, size, basis, scheduler).largest();
}

}  // namespace

FlightResult fly(SceneView& scene, Renderer& renderer, const FlightConfig& config, Scheduler& scheduler,
                 const OnFrame& on_frame) {
  if (config.cameras.empty()) throw InputError("a flight needs at least one camera");
  scene.upload(renderer);
  const auto whole = [&](std::size_t m) -> const Hierarchy& {
    return config.measured.empty() ? scene.hierarchy(m) : *config.measured[m];
  };
  std::vector<std::unique_ptr<Prover>> provers;
  std::vector<ScreenErrorBasis> screens;
  for (std::size_t m = 0; m < scene.model_count(); ++m) {
    if (config.measure) provers.push_back(std::make_unique<Prover>(whole(m), scene.limit_rate(m), scheduler));
    if (config.measure_screen) screens.emplace_back(whole(m));
  }

  FlightResult result;
  result.admissible = true;
  std::vector<double> totals;
  for (std::size_t i = 0; i < config.cameras.size(); ++i) {
    if (config.cancel && *config.cancel) throw Cancelled{};
    FrameRow row;
    const Stopwatch frame_time;
    row.drawn = scene.update(config.cameras[i], config.view);
    const double select = frame_time.milliseconds();
    const FrameStats stats = scene.draw(renderer);
    if (row.drawn) result.warnings.insert(result.warnings.end(), stats.warnings.begin(), stats.warnings.end());
    row.cells = stats.cells;
    row.triangles = stats.triangles;
    row.draw_calls = stats.draw_calls;
    row.work = stats.work;
    row.milliseconds = stats.milliseconds;
    row.milliseconds["select"] = select;
    row.milliseconds["total"] = frame_time.milliseconds();
    row.resident_bytes = scene.resident_bytes();
    row.complete = scene.complete();
    totals.push_back(row.milliseconds["total"]);
    result.admissible = result.admissible && scene.admissible();
    if (on_frame) on_frame(i, renderer);
    for (std::size_t m = 0; m < provers.size(); ++m) provers[m]->measure(scene.frame().models[m].morph, row);
    for (std::size_t m = 0; m < screens.size(); ++m)
      row.screen_error = std::max(row.screen_error, measured_screen_error(scene.frame().models[m], config.view.size,
                                                                          whole(m), screens[m], scheduler));

    result.open_edges_max = std::max(result.open_edges_max, row.open_edges);
    result.screen_error_max = std::max(result.screen_error_max, row.screen_error);
    result.gap_max = std::max(result.gap_max, row.gap_max);
    result.jump_over_bound_max = std::max(result.jump_over_bound_max, row.jump_over_bound);
    result.frames.push_back(std::move(row));
  }
  result.milliseconds_median = median_of(std::move(totals));
  return result;
}

}  // namespace lodestone
