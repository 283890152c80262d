// Experiment `flight`: what a morphing hierarchy draws along a camera path, or from viewpoints that are hard on it:
// what that costs, whether it cracks, how far it pops.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "experiments/studies/effects_parameter.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/flight_pictures.h"
#include "experiments/studies/frame_measures.h"
#include "experiments/studies/model_drawer.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/studies/viewpoints.h"
#include "experiments/subjects/render.h"
#include "render/backends/make_renderer.h"
#include "render/lod/blend_curve.h"

namespace lodestone {
namespace flight_study {

std::vector<std::string> blend_names() {
  std::vector<std::string> names;
  for (const Blend b : all_blends()) names.emplace_back(name_of(b));
  return names;
}

// A curve's text in its shortest form.
std::optional<std::string> usual_curve(const std::string& text) {
  if (!is_curve_text(text)) return std::nullopt;
  return text_of(blend_curve(text));
}

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{
      threads_parameter(),
      rounds_parameter(1),
      as_condition({"backend", "null", "", "that draws: null counts alone", 0, 0, backend_names()}),
      {"kappa0", 0.0, "cell sizes", "least selection radius; 0: by pixel_error", 0, 1e6, {}},
      {"kappa0_over_rho", 0.0, "", "kappa0 as a multiple of the admissible border instead; 0: not used", 0, 1e3, {}},
      {"pixel_error", 1.0, "pixels", "tolerance, where no kappa0 is given", 1e-3, 1e3, {}},
      {"radii", "per-level", "", "rule for the selection radii", 0, 0, {"per-level", "uniform", "adaptive"}},
      {"constraint", 1.0, "", "share of the constraint that adaptive radii keep; below 1 they may crack", 0, 1, {}},
      {"beta", RadiiConfig{}.beta, "cell sizes", "least width of a morph band", 1e-3, 100, {}},
      {"delta", 0.0, "cell sizes", "guard for a stale selection", 0, 100, {}},
      {"blend", "smoothstep", "", "blending function", 0, 0, blend_names(),
       OtherTexts{"or table:0,...,1 or polynomial:0,... of one's own", usual_curve}},
      {"metric", "euclidean", "", "distance", 0, 0, {"euclidean", "chebyshev"}},
      effects_parameter("of the pictures, that of the full model, too"),
      {"image", false, "", "measure the backend's pictures, too: error, and pops against the full model's", 0, 0, {}},
  };
  append(list, viewpoint_parameters());
  append(list, picture_parameters());
  append(list, in_core_build_parameters());
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  const ColumnNeed by_kappa0{{{"kappa0", 0.0, false}, {"kappa0_over_rho", 0.0, false}}};
  std::vector<ColumnInfo> list{
      {"rho", "", "reach in the metric of the run: the admissible border of uniform radii", accuracy},
      {"kappa0_used",
       "cell sizes",
       "least selection radius that was used; none with a tolerance in pixels",
       accuracy,
       {by_kappa0}},
      {"over_border", "", "kappa0 over the admissible border rho + 3 delta", accuracy, {by_kappa0}},
  };
  append(list, without(render_columns(), {"screen_error"}));
  append(list, needing({{{"image", true}}}, PictureSummary::columns()));
  return list;
}

// kappa0 as a multiple of the least admissible one, which models of one or two levels do not have.
double kappa0_of(double ratio, const Hierarchy& hierarchy, const RadiiConfig& config) {
  const double border = greatest_reach(hierarchy, config.metric) + 3 * double{config.delta};
  if (border <= 0)
    throw InputError(fmt::format(
        "kappa0_over_rho: any kappa0 is admissible for {} levels, there is no border; give kappa0, or smaller cells",
        hierarchy.levels.size()));
  return ratio * border;
}

RadiiConfig radii_of(const Parameters& parameters, const Hierarchy& hierarchy) {
  RadiiConfig config = radii_config(parameters.text("radii"), parameters.text("metric"));
  config.beta = static_cast<float>(parameters.number("beta"));
  config.delta = static_cast<float>(parameters.number("delta"));
  config.pixel_error = static_cast<float>(parameters.number("pixel_error"));
  config.constraint = static_cast<float>(parameters.number("constraint"));
  const double kappa0 = parameters.number("kappa0"), ratio = parameters.number("kappa0_over_rho");
  if (kappa0 > 0) config.kappa0 = static_cast<float>(kappa0);
  if (ratio > 0) config.kappa0 = static_cast<float>(kappa0_of(ratio, hierarchy, config));
  return config;
}

void add_border(Row& row, const RadiiConfig& config, const Hierarchy& hierarchy) {
  const double rho = greatest_reach(hierarchy, config.metric), border = rho + 3 * double{config.delta};
  row["rho"] = rho;
  row["kappa0_used"] = config.kappa0 ? Row(*config.kappa0) : Row();
  row["over_border"] = config.kappa0 && border > 0 ? Row(*config.kappa0 / border) : Row();
}

ViewConfig view_config(const Parameters& parameters, const RadiiConfig& radii) {
  ViewConfig view = view_of_model(view_size(parameters), parameters.integer("samples"));
  view.radii = radii;
  view.blend = blend_named(parameters.text("blend"));
  view.effects = effect_request(parameters);
  return view;
}

// Cracks and pops of every shot, and its picture against that of the full model where that is asked for.
void add_accuracy(Row& row, const Hierarchy& hierarchy, const ViewConfig& view, std::span<const Shot> shots,
                  const Study& study) {
  Scheduler& scheduler = *study.scheduler;
  const bool with_pictures = study.parameters.flag("image");
  const std::string backend = with_pictures ? study.parameters.text("backend") : "null";
  ModelDrawer picture(hierarchy, view, backend, scheduler);
  ModelDrawer full(hierarchy, at_full_detail(view), backend, scheduler);
  DrawnSurface drawn_surface(view.effects);
  SurfaceMeasures surface(hierarchy, view.size, scheduler);
  PictureMeasures pictures(scheduler);
  SurfaceSummary cracks_and_pops;
  PictureSummary summary;
  FlightPictures shown;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    check_cancelled(study.context);
    picture.draw(shots[i].camera);
    const ModelFrame frame = drawn_surface.of(picture.view().frame().only());
    cracks_and_pops.add(surface.measure(frame, shots[i]));
    if (with_pictures) {
      full.draw(shots[i].camera);
      const Image whole = full.renderer().read_back();
      const Image seen = picture.renderer().read_back();
      PictureSample sample = pictures.measure(seen, whole, frame.view_projection, shots[i].follows);
      shown.offer(seen, whole, sample.quality.flip.mean);
      summary.add(std::move(sample));
    }
    study.context.progress(static_cast<double>(i + 1) / static_cast<double>(shots.size()));
  }
  cracks_and_pops.add_to(row);
  summary.add_to(row);
  shown.write(study.context.directory, scheduler);
}

std::vector<Row> rows_of(const Parameters& parameters, const RunContext& context) {
  const Study study(parameters, context);
  const Hierarchy hierarchy = build_study_hierarchy(parameters, context, *study.scheduler);
  const RadiiConfig radii = radii_of(parameters, hierarchy);
  const ViewConfig view = view_config(parameters, radii);
  const std::vector<Shot> shots =
      viewpoints(hierarchy, make_radii(hierarchy, for_picture(radii, view.size, Camera{}.vertical_fov)), parameters);
  Row row;
  row["frame_count"] = shots.size();
  add_border(row, radii, hierarchy);
  ModelDrawer drawn(hierarchy, view, parameters.text("backend"), *study.scheduler);
  row.update(to_row(time_flight(drawn, shots, parameters.integer("rounds"), context)));
  row["admissible"] = drawn.view().admissible() && DrawnSurface(view.effects).morphs();
  if (context.repetition == 0) add_accuracy(row, hierarchy, view, shots, study);
  return {row};
}

std::vector<SettingFault> check(const Parameters& parameters) {
  SettingVerdict verdict;
  const bool kappa0 = parameters.number("kappa0") > 0, ratio = parameters.number("kappa0_over_rho") > 0;
  verdict.require(!kappa0 || !ratio, {"kappa0", "kappa0_over_rho"},
                  assignment(parameters, "kappa0") + " and " + assignment(parameters, "kappa0_over_rho") +
                      " exclude each other; give one of them");
  verdict.require(kappa0 || ratio || parameters.text("radii") != "uniform", {"radii"},
                  assignment(parameters, "radii") + " needs kappa0 or kappa0_over_rho");
  const bool adaptive = parameters.text("radii") == "adaptive";
  verdict.require(!adaptive || !(kappa0 || ratio), {"kappa0", "kappa0_over_rho", "radii"},
                  assignment(parameters, "radii") + " goes by pixel_error, without kappa0 and kappa0_over_rho");
  verdict.idle(!adaptive, "constraint", assignment(parameters, "radii"));
  verdict.idle(kappa0 || ratio, "pixel_error", assignment(parameters, kappa0 ? "kappa0" : "kappa0_over_rho"));
  const bool draws = parameters.text("backend") != "null";
  verdict.require(draws || !parameters.flag("image"), {"image", "backend"},
                  "image = true needs a backend that draws; set backend to soft or gl");
  verdict.idle(!draws, "samples", assignment(parameters, "backend"));
  check_viewpoints(verdict, parameters);
  check_picture(verdict, parameters);
  check_build(verdict, parameters);
  return std::move(verdict).faults();
}

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  check_frames(verdict);
  verdict.present("admissible");
  verdict.in_order("triangles", "surface_triangles");
  check_surface(verdict, parameters.text("blend") != "step");
  PictureSummary::check(verdict);
  return std::move(verdict).messages();
}

}  // namespace flight_study

Experiment flight_experiment() {
  using namespace flight_study;
  return {"flight",  "What does a morphing hierarchy draw along a path, where does it crack, and how far does it pop?",
          true,      parameters(),
          columns(), rows_of,
          verify,    check};
}

}  // namespace lodestone
