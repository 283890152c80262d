#include "experiments/subjects/render.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "experiments/metrics/drawn/screen.h"
#include "experiments/metrics/drawn/screen_error.h"
#include "parallel/scheduler/clock.h"
#include "render/lod/selection.h"

namespace lodestone {
namespace {

// Distance of the surface in the frame, drawn or culled, from the full one.
double measured_screen_error(const ModelFrame& model, ImageSize size, const Hierarchy& whole,
                             const MeasuredSurface& full, Scheduler& scheduler) {
  MorphContext morph = model.morph;
  morph.hierarchy = &whole;
  Selection all;
  select_cells(whole, *morph.radii, morph.viewpoint, {.limits = morph.limits}, all);
  return screen_error(MeasuredSurface(drawn_mesh(morph, all)), full, Screen(model.view_projection, size), scheduler)
      .largest();
}

class RenderRun {
 public:
  RenderRun(const RenderJob& job, SceneView& scene, Renderer& renderer, Scheduler& scheduler)
      : job_(job), scene_(scene), renderer_(renderer), scheduler_(scheduler) {
    scene.upload(renderer);
    for (std::size_t m = 0; m < scene.model_count(); ++m) {
      if (job.measure) proofs_.push_back(std::make_unique<FrameProof>(whole(m), scheduler));
      if (job.measure_screen) screens_.emplace_back(finest_mesh(whole(m)));
    }
  }

  void fly(std::size_t index, RenderResult& result) {
    FrameResult frame = draw(job_.cameras[index], result.warnings);
    result.admissible = result.admissible && scene_.admissible();
    job_.on_frame(index, renderer_);
    measure(index, frame);
    result.frames.push_back(std::move(frame));
  }

 private:
  [[nodiscard]] const Hierarchy& whole(std::size_t model) const {
    return job_.measured.empty() ? scene_.hierarchy(model) : *job_.measured[model];
  }

  FrameResult draw(const Camera& camera, std::vector<std::string>& warnings) {
    FrameResult frame;
    const CpuClock clock;
    frame.drawn = scene_.update(camera, job_.view);
    const double select = clock.elapsed().seconds;
    const FrameStats stats = scene_.draw(renderer_);
    frame.time = clock.elapsed();
    if (frame.drawn) warnings.insert(warnings.end(), stats.warnings.begin(), stats.warnings.end());
    frame.cells = stats.cells;
    frame.triangles = stats.triangles;
    frame.draw_calls = stats.draw_calls;
    frame.work = stats.work;
    frame.milliseconds = stats.milliseconds;
    frame.milliseconds["select"] = 1000 * select;
    frame.milliseconds["total"] = 1000 * frame.time.seconds;
    frame.resident_bytes = scene_.resident_bytes();
    frame.complete = scene_.complete();
    return frame;
  }

  void measure(std::size_t index, FrameResult& frame) {
    const auto& models = scene_.frame().models;
    if (!proofs_.empty()) frame.surface.emplace();
    for (std::size_t m = 0; m < proofs_.size(); ++m)
      add(*frame.surface, proofs_[m]->measure({.morph = models[m].morph,
                                               .view_projection = models[m].view_projection,
                                               .size = job_.view.size,
                                               .follows = index > 0,
                                               .thorough = false,
                                               .limit_rate = scene_.limit_rate(m)}));
    for (std::size_t m = 0; m < screens_.size(); ++m)
      frame.screen_error =
          std::max(frame.screen_error.value_or(0),
                   measured_screen_error(models[m], job_.view.size, whole(m), screens_[m], scheduler_));
  }

  const RenderJob& job_;
  SceneView& scene_;
  Renderer& renderer_;
  Scheduler& scheduler_;
  std::vector<std::unique_ptr<FrameProof>> proofs_;
  std::vector<MeasuredSurface> screens_;
};

// The path as one round.
FlightTimes times_of(const std::vector<FrameResult>& frames) {
  FlightTimes times;
  std::vector<StageTime> of_frames;
  double select = 0;
  for (const FrameResult& frame : frames) {
    of_frames.push_back(frame.time);
    select += frame.milliseconds.at("select");
    times.triangles += static_cast<double>(frame.triangles), times.cells += static_cast<double>(frame.cells);
  }
  const auto count = static_cast<double>(frames.size());
  times.frames.add(of_frames);
  times.select_ms.push_back(select / count);
  times.triangles /= count, times.cells /= count;
  return times;
}

}  // namespace

RadiiConfig radii_config(const std::string& rule, const std::string& metric) {
  constexpr RadiiRule rules[] = {RadiiRule::adaptive, RadiiRule::per_level, RadiiRule::uniform};
  const auto* const found = std::ranges::find(rules, rule, [](RadiiRule r) { return name_of(r); });
  if (found == std::end(rules))
    throw InputError("--radii " + rule + ": unknown; " + known_names(rule, {"adaptive", "per-level", "uniform"}));
  if (metric != "euclidean" && metric != "chebyshev")
    throw InputError("--metric " + metric + ": unknown; " + known_names(metric, {"euclidean", "chebyshev"}));
  RadiiConfig config;
  config.rule = *found;
  if (metric == "chebyshev") config.metric = DistanceMetric::chebyshev;
  return config;
}

RenderResult run(const RenderJob& job, SceneView& scene, Renderer& renderer, Scheduler& scheduler) {
  if (job.cameras.empty()) throw InputError("a flight needs at least one camera");
  RenderRun flight(job, scene, renderer, scheduler);
  RenderResult result;
  for (std::size_t i = 0; i < job.cameras.size(); ++i) {
    if (job.cancel && *job.cancel) throw Cancelled{};
    flight.fly(i, result);
  }
  return result;
}

std::vector<ColumnInfo> render_columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list{{"frame_count", "", "number of viewpoints", count},
                               {"admissible", "", "every morph band has a width: no crack, no pop", label}};
  append(list, flight_columns());
  append(list, SurfaceSummary::columns());
  list.push_back(
      {"screen_error", "pixels", "largest distance in the picture between the drawn and the full model", accuracy});
  return list;
}

Row to_row(const RenderResult& result) {
  Row row = to_row(times_of(result.frames));
  row["frame_count"] = result.frames.size(), row["admissible"] = result.admissible;
  SurfaceSummary surface;
  std::optional<double> screen_error;
  for (const FrameResult& frame : result.frames) {
    if (frame.surface) surface.add(*frame.surface);
    if (frame.screen_error) screen_error = std::max(screen_error.value_or(0), *frame.screen_error);
  }
  if (!result.frames.empty() && result.frames.front().surface) surface.add_to(row);
  row["screen_error"] = or_null(screen_error);
  return row;
}

Row to_row(const FrameResult& frame) {
  Row row{{"cells", frame.cells}, {"triangles", frame.triangles}, {"screen_error", or_null(frame.screen_error)}};
  if (!frame.surface) return row;
  const SurfaceSample& surface = *frame.surface;
  row.update({{"surface_triangles", surface.triangles}, {"open_edges", surface.open_edges}, {"gap_max", surface.gap}});
  if (surface.jump)
    row.update({{"jump_pixels", surface.jump->pixels},
                {"viewpoint_step", surface.jump->step},
                {"jump_max", surface.jump->largest},
                {"jump_over_bound", or_null(surface.jump->over_bound)},
                {"jump_bound_vacuous", surface.jump->vacuous}});
  return row;
}

}  // namespace lodestone
