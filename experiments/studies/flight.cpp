// Experiment `flight`: what a morphing hierarchy draws along a camera path, or from viewpoints that are hard on it:
// what that costs, whether it cracks, how far it pops.
#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "experiments/studies/catalogue.h"
#include "experiments/studies/effects_parameter.h"
#include "experiments/studies/frame_measures.h"
#include "experiments/studies/model_drawer.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/row_verdict.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/viewpoints.h"

namespace lodestone {
namespace {

std::vector<std::string> blend_names() {
  std::vector<std::string> names;
  for (const Blend b : all_blends()) names.emplace_back(name_of(b));
  return names;
}

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{
      threads_parameter(),
      rounds_parameter(1),
      {"backend", "null", "", "that draws: null counts alone", 0, 0, {"null", "soft", "gl"}},
      {"kappa0", 0.0, "cell sizes", "least selection radius; 0: by pixel_error", 0, 1e6, {}},
      {"kappa0_over_rho", 0.0, "", "kappa0 as a multiple of the admissible border instead; 0: not used", 0, 1e3, {}},
      {"pixel_error", 1.0, "pixels", "tolerance, where no kappa0 is given", 1e-3, 1e3, {}},
      {"radii", "per-level", "", "rule for the selection radii", 0, 0, {"per-level", "uniform"}},
      {"beta", RadiiConfig{}.beta, "cell sizes", "least width of a morph band", 1e-3, 100, {}},
      {"delta", 0.0, "cell sizes", "guard for a stale selection", 0, 100, {}},
      {"blend", "smoothstep", "", "blending function", 0, 0, blend_names()},
      {"metric", "euclidean", "", "distance", 0, 0, {"euclidean", "chebyshev"}},
      effects_parameter("of the pictures, that of the full model, too"),
      {"image", false, "", "measure pictures, too: error, and pops against the full model's", 0, 0, {}},
  };
  append(list, viewpoint_parameters());
  append(list, picture_parameters());
  append(list, build_parameters());
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list{
      {"frame_count", "", "viewpoints", count},
      {"rho", "", "reach in the metric of the run: the admissible border of uniform radii", accuracy},
      {"kappa0_used", "cell sizes", "least selection radius that was used; none with a tolerance in pixels", accuracy},
      {"over_border", "", "kappa0 over the admissible border rho + 3 delta", accuracy},
      {"admissible", "", "every morph band has a width: no crack, no pop", label},
      {"triangles", "", "drawn in a frame, mean", cost},
      {"cells", "", "drawn in a frame, mean", cost},
      {"select_ms", "ms", "radii and selection of a frame, median", cost},
  };
  add_spread_columns(list, "frame_ms", "ms", "a frame, from camera to picture");
  append(list, SurfaceSummary::columns());
  append(list, PictureSummary::columns());
  return list;
}

RadiiConfig radii_config(const Parameters& parameters, const Hierarchy& hierarchy) {
  RadiiConfig config;
  config.rule = parameters.text("radii") == "uniform" ? RadiiRule::uniform : RadiiRule::per_level;
  config.metric = parameters.text("metric") == "euclidean" ? DistanceMetric::euclidean : DistanceMetric::chebyshev;
  config.beta = static_cast<float>(parameters.number("beta"));
  config.delta = static_cast<float>(parameters.number("delta"));
  config.pixel_error = static_cast<float>(parameters.number("pixel_error"));
  const double kappa0 = parameters.number("kappa0"), ratio = parameters.number("kappa0_over_rho");
  if (kappa0 > 0 && ratio > 0) throw InputError("kappa0 and kappa0_over_rho exclude each other; give one of them");
  if (kappa0 > 0) config.kappa0 = static_cast<float>(kappa0);
  if (ratio > 0)
    config.kappa0 = static_cast<float>(ratio * (reach(hierarchy, config.metric) + 3 * double{config.delta}));
  return config;
}

void add_border(Row& row, const RadiiConfig& config, const Hierarchy& hierarchy) {
  const double rho = reach(hierarchy, config.metric), border = rho + 3 * double{config.delta};
  row["rho"] = rho;
  row["kappa0_used"] = config.kappa0 ? Row(*config.kappa0) : Row();
  row["over_border"] = config.kappa0 && border > 0 ? Row(*config.kappa0 / border) : Row();
}

void add_times(Row& row, const FlightTimes& times) {
  add_spread(row, "frame_ms", times.frame_ms);
  row["select_ms"] = spread_of(times.select_ms).median;
  row["triangles"] = times.triangles, row["cells"] = times.cells;
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const auto scheduler = study_scheduler(parameters);
  const Hierarchy hierarchy = build_study_hierarchy(parameters, context, *scheduler);
  const RadiiConfig radii = radii_config(parameters, hierarchy);
  const ImageSize size = view_size(parameters);
  ViewConfig view = view_of_model(size, parameters.integer("samples"));
  view.radii = radii;
  view.blend = blend(parameters.text("blend"));
  view.effects = effect_request(parameters);
  const std::vector<Shot> shots = viewpoints(hierarchy, make_radii(hierarchy, radii), parameters);

  Row row;
  row["frame_count"] = shots.size();
  add_border(row, radii, hierarchy);
  ModelDrawer drawn(hierarchy, view, parameters.text("backend"), *scheduler);
  add_times(row, time_flight(drawn, shots, parameters.integer("rounds"), context));
  DrawnSurface drawn_surface(view.effects);
  row["admissible"] = drawn.view().admissible() && drawn_surface.morphs();
  if (context.repetition > 0) return {row};

  SurfaceMeasures surface(hierarchy, *scheduler);
  const bool with_pictures = parameters.flag("image");
  ModelDrawer picture(hierarchy, view, with_pictures ? "soft" : "null", *scheduler);
  ModelDrawer full(hierarchy, at_full_detail(view), with_pictures ? "soft" : "null", *scheduler);
  PictureMeasures pictures(*scheduler);
  SurfaceSummary cracks_and_pops;
  PictureSummary summary;
  WorstPicture worst;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    check_cancelled(context);
    picture.draw(shots[i].camera);
    const ModelFrame frame = drawn_surface.of(picture.view().frame().only());
    Image whole;
    if (with_pictures) {
      full.draw(shots[i].camera);
      whole = full.renderer().read_back();
    }
    cracks_and_pops.add(surface.measure(frame, size, shots[i].follows, with_pictures ? &whole : nullptr));
    if (with_pictures) {
      const Image seen = picture.renderer().read_back();
      PictureSample sample = pictures.measure(seen, whole, frame.view_projection, shots[i].follows);
      worst.offer(seen, whole, sample.quality.flip.mean);
      summary.add(std::move(sample));
    }
    context.progress(static_cast<double>(i + 1) / static_cast<double>(shots.size()));
  }
  cracks_and_pops.add_to(row);
  summary.add_to(row);
  worst.write(context.directory, *scheduler);
  return {row};
}

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.spread("frame_ms");
  verdict.present("admissible");
  verdict.in_order("triangles", "surface_triangles");
  SurfaceSummary::check(verdict, parameters.text("blend") != "step");
  PictureSummary::check(verdict);
  return std::move(verdict).messages();
}

}  // namespace

Experiment flight_experiment() {
  return {"flight",  "What does a morphing hierarchy draw along a path, where does it crack, and how far does it pop?",
          true,      parameters(),
          columns(), run,
          verify};
}

}  // namespace lodestone
