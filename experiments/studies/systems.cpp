// Experiment `systems`: the same model, the same path and the same radii under several systems of levels of detail, by
// the same measures of cracks and pops.
//
// A run is one system, so that its frame times and its processor time are its own; systems are compared by repetitions
// that take turns. Timing passes come first and measure nothing else.
#include <algorithm>

#include "core/base/error.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/studies/effects_parameter.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/flight_pictures.h"
#include "experiments/studies/frame_measures.h"
#include "experiments/studies/model_drawer.h"
#include "experiments/studies/picture_summary.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/studies/viewpoints.h"
#include "experiments/subjects/frame_proof.h"
#include "experiments/subjects/frame_times.h"
#include "experiments/systems/system_flight.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/make_renderer.h"

namespace lodestone {
namespace systems_study {

std::vector<std::string> system_names() {
  std::vector<std::string> names;
  for (const std::string& name : lod_system_names())
    if (name != full_system) names.push_back(name);
  return names;
}

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{
      threads_parameter(),
      rounds_parameter(3),
      {"system", "morph", "", "of levels of detail", 0, 0, system_names()},
      as_condition({"backend", "soft", "", "that draws", 0, 0, picture_backend_names()}),
      {"pixel_error", 1.0, "pixels", "tolerance that all systems keep to", 1e-3, 1e3, {}},
      effects_parameter("of all pictures; geomorph, which is the system's own, runs in any case"),
      {"fade_width", 0.25, "", "of cross-fade: way of a fade over the distance at which it begins", 0, 10, {}},
      camera_parameter("path"),
  };
  append(list, path_parameters());
  append(list, picture_parameters());
  append(list, build_parameters());
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list{
      {"admissible", "", "the system promises neither cracks nor pops with these radii", label},
      {"triangles", "", "drawn in a frame, mean", cost},
      {"pictures", "", "drawn for a frame, mean", cost},
      {"make_cpu_seconds", "s", "processor time to make what the system draws from, from the mesh, or the finest level",
       cost},
      {"peak_bytes", "bytes", "largest resident set while making that and drawing, the model included", cost},
      {"drawn_bytes", "bytes", "vertices and triangles of the surface as drawn, before culling, mean over the frames",
       cost},
      {"screen_error", "pixels", "largest distance on the screen between the drawn and the full surface", accuracy},
      {"shift_pixels", "pixels",
       "largest distance on the screen between the surface and that of the frame before, by one camera", accuracy},
  };
  append(list, frame_columns("a frame, from camera to picture, reading it back for a blend included"));
  for (ColumnInfo& column : SurfaceSummary::columns()) {
    for (const std::string& system : system_names())
      if ((column.name.starts_with("jump_") && !lod_system(system).moves_vertices) ||
          (column.name.starts_with("gap_") && lod_system(system).patches))
        column.needs.push_back({{{"system", system, false}}});
    list.push_back(std::move(column));
  }
  append(list, PictureSummary::columns());
  return list;
}

void add_times(Row& row, SystemPictures& pictures, const SystemFlightConfig& config, const Study& study) {
  FrameRounds times;
  double drawn = 0, triangles = 0;
  for (int round = 0; round <= study.parameters.integer("rounds"); ++round) {
    std::vector<StageTime> frames;
    drawn = triangles = 0;  // the same in every round
    for (const Camera& camera : config.cameras) {
      check_cancelled(study.context);
      const CpuClock clock;
      const SystemPicture picture = pictures.draw(config.systems.front(), camera, config.view);
      frames.push_back(clock.elapsed());
      drawn += picture.pictures, triangles += static_cast<double>(picture.stats.triangles);
    }
    if (round > 0) times.add(frames);  // the first one warms up
  }
  const auto count = static_cast<double>(config.cameras.size());
  add_frames(row, times);
  row["pictures"] = drawn / count, row["triangles"] = triangles / count;
}

void add_accuracy(Row& row, SceneView& scene, Renderer& renderer, const SystemFlightConfig& config,
                  const Study& study) {
  SurfaceSummary cracks_and_pops;
  PictureSummary seen;
  FlightPictures shown;
  double screen_error = 0, shift = 0, bytes = 0;
  (void)fly_systems(
      scene, renderer, config, *study.scheduler,
      [&](const SystemRow& frame, const SystemPicture& drawn, const Image& full) {
        cracks_and_pops.add(*frame.surface);
        for (const SystemModel& model : drawn.models) bytes += static_cast<double>(drawn_bytes(model));
        screen_error = std::max(screen_error, frame.screen_error.value_or(0));
        shift = std::max(shift, frame.shift_pixels.value_or(0));
        seen.add({frame.quality, frame.pops});
        shown.offer(drawn.image, full, frame.quality.flip.mean);
        study.context.progress(static_cast<double>(frame.frame) / static_cast<double>(config.cameras.size()));
      });
  cracks_and_pops.add_to(row);
  if (lod_system(config.systems.front()).patches)
    for (const std::string gap : {"gap_max", "gap_mean", "gap_pixels", "gap_mean_pixels"}) row[gap] = nullptr;
  row["screen_error"] = screen_error, row["shift_pixels"] = shift;
  row["drawn_bytes"] = bytes / static_cast<double>(config.cameras.size());
  seen.add_to(row);
  shown.write(study.context.directory, *study.scheduler);
}

SystemFlightConfig flight_config(const Parameters& parameters, const Hierarchy& hierarchy, const RunContext& context) {
  SystemFlightConfig config;
  config.view = view_of_model(view_size(parameters), parameters.integer("samples"));
  config.view.radii.pixel_error = static_cast<float>(parameters.number("pixel_error"));
  config.view.effects = effect_request(parameters);
  config.view.effects.listed.insert(Effect::geomorph);
  config.systems = {parameters.text("system")};
  config.system.fade_width = parameters.number("fade_width");
  config.screen = true;
  config.cancel = context.cancel;
  config.cameras = path_cameras(hierarchy, parameters);
  return config;
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const Study study(parameters, context);
  const CpuClock clock;
  const Hierarchy hierarchy = build_study_hierarchy(parameters, context, *study.scheduler);
  double made = clock.elapsed().cpu_seconds;
  const SystemFlightConfig config = flight_config(parameters, hierarchy, context);
  SceneView scene(scene_of("input"), {{&hierarchy}});
  const auto renderer = make_renderer(parameters.text("backend"), *study.scheduler);
  const CostMeter meter;
  Row row;
  SystemPictures pictures(scene, *renderer, *study.scheduler, config.system);
  if (lod_system(config.systems.front()).patches) made = pictures.prepare(config.systems.front()).cpu_seconds;
  row["make_cpu_seconds"] = made;
  add_times(row, pictures, config, study);
  row["peak_bytes"] = meter.elapsed().peak_memory;
  row["admissible"] = lod_system(config.systems.front()).keeps_promise && scene.admissible();
  if (context.repetition == 0) add_accuracy(row, scene, *renderer, config, study);
  return {row};
}

std::vector<SettingFault> check(const Parameters& parameters) {
  SettingVerdict verdict;
  verdict.idle(parameters.text("system") != "cross-fade", "fade_width", assignment(parameters, "system"));
  check_path(verdict, parameters);
  check_picture(verdict, parameters);
  check_build(verdict, parameters);
  return std::move(verdict).faults();
}

std::vector<std::string> verify(const Parameters&, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  check_frames(verdict);
  verdict.present("admissible");
  check_surface(verdict, true);
  PictureSummary::check(verdict);
  return std::move(verdict).messages();
}

}  // namespace systems_study

Experiment systems_experiment() {
  using namespace systems_study;
  return {"systems", "On the same path, what cracks and what pops under which system of levels of detail?",
          true,      parameters(),
          columns(), systems_study::run,
          verify,    check};
}

}  // namespace lodestone
