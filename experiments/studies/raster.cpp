// Experiment `raster`: what drawing costs, and how near the picture is to that of the full model.
#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/metrics/cost.h"
#include "experiments/metrics/image_quality.h"
#include "experiments/metrics/screen_error.h"
#include "experiments/studies/catalogue.h"
#include "experiments/studies/effects_parameter.h"
#include "experiments/studies/model_drawer.h"
#include "experiments/studies/result_hash.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/row_verdict.h"
#include "experiments/studies/study_input.h"

namespace lodestone {
namespace {

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{
      threads_parameter(),
      rounds_parameter(3),
      {"backend", "soft", "", "that draws", 0, 0, {"null", "soft", "gl"}},
      {"pixel_error", 1.0, "pixels", "tolerance", 1e-3, 1e3, {}},
      effects_parameter("of the pictures, that of the full model, too"),
      {"measured_frames", 4, "", "frames whose picture is held against that of the full model", 0, 10000, {}},
  };
  append(list, viewpoint_parameters());
  append(list, picture_parameters());
  append(list, build_parameters());
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list{
      {"input_triangles", "", "of the model", count},
      {"triangles", "", "drawn in a frame, mean", cost},
      {"first_frame_ms", "ms", "of the first frame, with what it uploads and compiles", cost},
      {"select_ms", "ms", "radii and selection of a frame, median", cost},
      {"frame_cpu_ms", "ms", "processor time of a frame, all threads, median", cost},
      {"mtri_per_second", "million/s", "triangles drawn over the frame time", cost},
      {"peak_memory", "bytes", "largest resident set while drawing, the model included", cost},
      {"screen_error", "pixels", "largest distance in the picture between what is drawn and the full model", accuracy},
      {"image_error", "%", "mean difference from the full model's picture", accuracy},
      {"psnr", "dB", "of the worst picture that differs at all", quality},
      {"ssim", "", "of the worst picture", quality},
      {"flip", "", "mean FLIP of the worst picture", accuracy},
      {"hash", "", "of all pictures", label},
      {"same", "", "a single thread draws the same pictures", label},
  };
  add_spread_columns(list, "frame_ms", "ms", "a frame, from camera to picture");
  return list;
}

// Of all pictures, in their order; each is drawn anew.
std::uint64_t hash_of_pictures(ModelDrawer& drawer, std::span<const Shot> shots, const RunContext& context) {
  std::uint64_t sum = 0;
  for (const Shot& shot : shots) {
    check_cancelled(context);
    drawer.draw(shot.camera);
    sum = sum * 31 + hash_of(drawer.renderer().read_back());
  }
  return sum;
}

// What is worst of some frames, against the full model drawn by the same backend.
class WorstFrame {
 public:
  explicit WorstFrame(const EffectRequest& effects) : surface_(effects) {}

  void measure(ModelDrawer& drawn, ModelDrawer& full, const Shot& shot, ImageSize size, const ScreenErrorBasis& basis,
               Scheduler& scheduler) {
    drawn.draw(shot.camera);
    const ModelFrame frame = surface_.of(drawn.view().frame().only());
    Selection whole;
    select_cells(*frame.morph.hierarchy, *frame.morph.radii, frame.morph.viewpoint, {}, whole);
    screen_ =
        std::max(screen_, screen_error(frame.morph, whole, frame.view_projection, size, basis, scheduler).largest());
    full.draw(shot.camera);
    const Image picture = drawn.renderer().read_back();
    if (picture.rgba.empty()) return;
    const ImageQuality quality = image_quality(full.renderer().read_back(), picture, scheduler);
    pictures_ = true;
    mean_ = std::max(mean_, quality.mean_absolute), flip_ = std::max(flip_, quality.flip.mean);
    psnr_ = std::min(psnr_, quality.psnr), ssim_ = std::min(ssim_, quality.ssim);
  }

  void add_to(Row& row) const {
    row["screen_error"] = screen_;
    if (!pictures_) return;
    row["image_error"] = 100 * mean_, row["flip"] = flip_, row["ssim"] = ssim_;
    row["psnr"] = std::isfinite(psnr_) ? Row(psnr_) : Row();
  }

 private:
  DrawnSurface surface_;
  bool pictures_ = false;
  double screen_ = 0, mean_ = 0, flip_ = 0, ssim_ = 1, psnr_ = std::numeric_limits<double>::infinity();
};

void add_accuracy(Row& row, ModelDrawer& drawn, const ViewConfig& view, const Hierarchy& hierarchy,
                  std::span<const Shot> shots, const Parameters& parameters, const RunContext& context,
                  Scheduler& scheduler) {
  const std::string backend = parameters.text("backend");
  const auto serial = make_serial_scheduler();
  ModelDrawer alone(hierarchy, view, backend, *serial);
  row["same"] = hash_of_pictures(alone, shots, context) == hash_of_pictures(drawn, shots, context);

  const std::size_t measured = std::min<std::size_t>(shots.size(), parameters.json().at("measured_frames"));
  if (measured == 0) return;
  ModelDrawer full(hierarchy, at_full_detail(view), backend, scheduler);
  const ScreenErrorBasis basis(hierarchy);
  WorstFrame worst(view.effects);
  for (std::size_t i = 0; i < measured; ++i) {
    check_cancelled(context);
    worst.measure(drawn, full, shots[i * shots.size() / measured], view_size(parameters), basis, scheduler);
  }
  worst.add_to(row);
  if (backend != "null") write_png(context.directory + "/last.png", drawn.renderer().read_back());
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const auto scheduler = study_scheduler(parameters);
  const Hierarchy hierarchy = build_study_hierarchy(parameters, context, *scheduler);
  ViewConfig view = view_of_model(view_size(parameters), parameters.integer("samples"));
  view.radii.pixel_error = static_cast<float>(parameters.number("pixel_error"));
  view.effects = effect_request(parameters);
  const std::vector<Shot> shots = viewpoints(hierarchy, make_radii(hierarchy, view.radii), parameters);

  Row row;
  const CostMeter meter;
  ModelDrawer drawn(hierarchy, view, parameters.text("backend"), *scheduler);
  row["first_frame_ms"] = drawn.draw(shots.back().camera).total_ms;
  const FlightTimes times = time_flight(drawn, shots, parameters.integer("rounds"), context);
  row["peak_memory"] = meter.elapsed().peak_memory;
  add_spread(row, "frame_ms", times.frame_ms);
  row["select_ms"] = spread_of(times.select_ms).median, row["frame_cpu_ms"] = spread_of(times.cpu_ms).median;
  row["triangles"] = times.triangles, row["input_triangles"] = hierarchy.provenance.input_triangles;
  row["mtri_per_second"] = times.triangles * 1e-3 / row["frame_ms"].get<double>();
  row["hash"] = to_hex(hash_of_pictures(drawn, shots, context));
  if (context.repetition == 0) add_accuracy(row, drawn, view, hierarchy, shots, parameters, context, *scheduler);
  return {row};
}

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.spread("frame_ms");
  verdict.present("hash");
  verdict.is_true("same");
  // The tolerance is a bound for estimated errors; decision 0004 says how far an estimate may be off.
  verdict.at_most("screen_error", 2 * parameters.number("pixel_error"));
  for (const char* column : {"ssim", "flip"}) verdict.at_most(column, 1 + 1e-9);
  verdict.at_most("image_error", 100);
  return std::move(verdict).messages();
}

}  // namespace

Experiment raster_experiment() {
  return {"raster",  "What does a frame cost, and how near is it to the picture of the full model?",
          true,      parameters(),
          columns(), run,
          verify};
}

}  // namespace lodestone
