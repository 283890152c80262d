// Experiment `raster`: what drawing costs, and how near the picture is to that of the full model.
#include <algorithm>

#include "experiments/metrics/cost/cost.h"
#include "experiments/metrics/drawn/screen.h"
#include "experiments/metrics/drawn/screen_error.h"
#include "experiments/metrics/pictures/image_quality.h"
#include "experiments/studies/effects_parameter.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/model_drawer.h"
#include "experiments/studies/picture_summary.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/result_hash.h"
#include "render/backends/make_renderer.h"

namespace lodestone {
namespace raster_study {

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{
      threads_parameter(),
      rounds_parameter(3),
      as_condition({"backend", "soft", "", "that draws", 0, 0, backend_names()}),
      {"pixel_error", 1.0, "pixels", "tolerance", 1e-3, 1e3, {}},
      effects_parameter("of the pictures, that of the full model, too"),
      as_condition(
          {"measured_frames", 4, "", "frames whose picture is held against that of the full model", 0, 10000, {}}),
  };
  append(list, viewpoint_parameters());
  append(list, picture_parameters());
  append(list, in_core_build_parameters());
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  const ColumnNeed measured{{{"measured_frames", 0, false}}}, drawn{{{"backend", "null", false}}};
  std::vector<ColumnInfo> list{
      {"input_triangles", "", "of the model", count},
      {"first_frame_ms", "ms", "of the first frame, with what it uploads and compiles", cost},
      {"mtri_per_second", "million/s", "triangles drawn over frame_ms", cost},
      {"peak_bytes", "bytes", "largest resident set while drawing, the model included", cost},
      {"screen_error",
       "pixels",
       "largest distance in the picture between what is drawn and the full model",
       accuracy,
       {measured}},
      {"hash", "", "of all pictures", label},
      {"same", "", "a single thread draws the same pictures", label},
  };
  append(list, flight_columns());
  append(list, needing(measured, needing(drawn, QualitySummary::columns())));
  return list;
}

// Hash of all pictures, in their order; each is drawn anew.
std::uint64_t hash_of_pictures(ModelDrawer& drawer, std::span<const Shot> shots, const RunContext& context) {
  std::uint64_t sum = 0;
  for (const Shot& shot : shots) {
    check_cancelled(context);
    drawer.draw(shot.camera);
    sum = sum * 31 + hash_of(drawer.renderer().read_back());
  }
  return sum;
}

// Some frames against the full model drawn by the same backend.
class FrameAccuracy {
 public:
  explicit FrameAccuracy(const EffectRequest& effects) : surface_(effects) {}

  void measure(ModelDrawer& drawn, ModelDrawer& full, const Shot& shot, ImageSize size, const MeasuredSurface& finest,
               Scheduler& scheduler) {
    drawn.draw(shot.camera);
    const ModelFrame frame = surface_.of(drawn.view().frame().only());
    Selection whole;
    select_cells(*frame.morph.hierarchy, *frame.morph.radii, frame.morph.viewpoint, {}, whole);
    const MeasuredSurface surface(drawn_mesh(frame.morph, whole));
    screen_ =
        std::max(screen_, screen_error(surface, finest, Screen(frame.view_projection, size), scheduler).largest());
    full.draw(shot.camera);
    const Image picture = drawn.renderer().read_back();
    if (picture.rgba.empty()) return;
    quality_.add(image_quality(full.renderer().read_back(), picture, scheduler));
  }

  void add_to(Row& row) const {
    row["screen_error"] = screen_;
    quality_.add_to(row);
  }

 private:
  DrawnSurface surface_;
  double screen_ = 0;
  QualitySummary quality_;
};

void add_accuracy(Row& row, ModelDrawer& drawn, const ViewConfig& view, const Hierarchy& hierarchy,
                  std::span<const Shot> shots, const Study& study) {
  const std::string backend = study.parameters.text("backend");
  const auto serial = make_serial_scheduler();
  ModelDrawer alone(hierarchy, view, backend, *serial);
  row["same"] = hash_of_pictures(alone, shots, study.context) == hash_of_pictures(drawn, shots, study.context);

  const std::size_t measured = std::min(shots.size(), study.parameters.json().at("measured_frames").get<std::size_t>());
  if (measured == 0) return;
  ModelDrawer full(hierarchy, at_full_detail(view), backend, *study.scheduler);
  const MeasuredSurface finest(finest_mesh(hierarchy));
  FrameAccuracy accuracy(view.effects);
  for (std::size_t i = 0; i < measured; ++i) {
    check_cancelled(study.context);
    accuracy.measure(drawn, full, shots[i * shots.size() / measured], view.size, finest, *study.scheduler);
  }
  accuracy.add_to(row);
  if (backend != "null") write_png(study.context.directory + "/last.png", drawn.renderer().read_back());
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const Study study(parameters, context);
  const Hierarchy hierarchy = build_study_hierarchy(parameters, context, *study.scheduler);
  ViewConfig view = view_of_model(view_size(parameters), parameters.integer("samples"));
  view.radii.pixel_error = static_cast<float>(parameters.number("pixel_error"));
  view.effects = effect_request(parameters);
  const std::vector<Shot> shots = viewpoints(hierarchy, make_radii(hierarchy, view.radii), parameters);

  const CostMeter meter;
  ModelDrawer drawn(hierarchy, view, parameters.text("backend"), *study.scheduler);
  const double first_frame = drawn.draw(shots.back().camera).time.seconds;
  Row row = to_row(time_flight(drawn, shots, parameters.integer("rounds"), context));
  row["peak_bytes"] = meter.elapsed().peak_memory;
  row["first_frame_ms"] = 1000 * first_frame;
  row["input_triangles"] = hierarchy.provenance.input_triangles;
  row["mtri_per_second"] = row["triangles"].get<double>() * 1e-3 / row["frame_ms"].get<double>();
  row["hash"] = to_hex(hash_of_pictures(drawn, shots, context));
  if (context.repetition == 0) add_accuracy(row, drawn, view, hierarchy, shots, study);
  return {row};
}

std::vector<SettingFault> check(const Parameters& parameters) {
  SettingVerdict verdict;
  verdict.idle(parameters.text("backend") == "null", "samples", assignment(parameters, "backend"));
  check_viewpoints(verdict, parameters);
  check_picture(verdict, parameters);
  check_build(verdict, parameters);
  return std::move(verdict).faults();
}

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  check_frames(verdict);
  verdict.present("hash");
  verdict.is_true("same");
  // The tolerance is a bound for estimated errors; decision 0004 says how far an estimate may be off.
  verdict.at_most("screen_error", 2 * parameters.number("pixel_error"));
  QualitySummary::check(verdict);
  return std::move(verdict).messages();
}

}  // namespace raster_study

Experiment raster_experiment() {
  using namespace raster_study;
  return {"raster",  "What does a frame cost, and how near is it to the picture of the full model?",
          true,      parameters(),
          columns(), raster_study::run,
          verify,    check};
}

}  // namespace lodestone
