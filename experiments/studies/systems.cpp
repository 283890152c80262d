// Experiment `systems`: the same model, the same path and the same radii under several systems of levels of detail, by
// the same measures of cracks and pops.
//
// A run is one system, so that its frame times and its processor time are its own; systems are compared by repetitions
// that take turns. Timing passes come first and measure nothing else.
#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "experiments/studies/catalogue.h"
#include "experiments/studies/effects_parameter.h"
#include "experiments/studies/frame_measures.h"
#include "experiments/studies/frame_rounds.h"
#include "experiments/studies/model_drawer.h"
#include "experiments/studies/picture_summary.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/row_verdict.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/surface_summary.h"
#include "experiments/studies/viewpoints.h"
#include "experiments/systems/system_flight.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/make_renderer.h"

namespace lodestone {
namespace {

std::vector<std::string> system_names() {
  std::vector<std::string> names;
  for (const LodSystem system : all_lod_systems())
    if (system != LodSystem::full) names.emplace_back(name_of(system));
  return names;
}

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{
      threads_parameter(),
      rounds_parameter(3),
      {"system", "morph", "", "of levels of detail", 0, 0, system_names()},
      {"backend", "soft", "", "that draws", 0, 0, {"soft", "gl"}},
      {"pixel_error", 1.0, "pixels", "tolerance that all systems keep to", 1e-3, 1e3, {}},
      effects_parameter("of all pictures; geomorph, which is the system's own, runs in any case"),
      {"fade_width", 0.25, "", "of cross-fade: way of a fade over the distance at which it begins", 0, 10, {}},
      camera_parameter("path", {"orbit", "fly-in"}),
  };
  append(list, path_parameters());
  append(list, picture_parameters());
  append(list, build_parameters());
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  const ColumnNeed of_vertices{{{"system", "cross-fade", false}}};  // which moves none
  std::vector<ColumnInfo> list{
      {"admissible", "", "the system promises neither cracks nor pops with these radii", label},
      {"triangles", "", "drawn in a frame, mean", cost},
      {"pictures", "", "drawn for a frame, mean", cost},
  };
  append(list, frame_columns("a frame, from camera to picture, reading it back for a blend included"));
  for (ColumnInfo& column : SurfaceSummary::columns()) {
    if (column.name.starts_with("jump_")) column.needs.push_back(of_vertices);
    list.push_back(std::move(column));
  }
  append(list, PictureSummary::columns());
  return list;
}

// Lengths of a row are in the units of the model.
SurfaceSample surface_of(const SystemRow& row, const SystemModel& model, bool follows) {
  const double percent = 100 / model.hierarchy->transform.scale;
  SurfaceSample sample;
  for (const SelectedCell& s : model.whole.cells)
    sample.triangles += static_cast<double>(model.hierarchy->cells[s.cell].triangles.size());
  sample.open_edges = static_cast<double>(row.open_edges);
  sample.gap = percent * row.gap_max, sample.gap_mean = percent * row.gap_mean, sample.gap_pixels = row.gap_max_pixels;
  sample.gap_mean_pixels = row.gap_mean_pixels;
  sample.t_junctions = static_cast<double>(row.t_junctions);
  if (row.closed) {
    sample.torn_pixels = static_cast<double>(row.torn_pixels);
    sample.leak_pixels = static_cast<double>(row.leak_pixels);
  }
  // Nothing moves in a cross-fade: what changes is in the pictures alone.
  if (!follows || row.system == LodSystem::cross_fade) return sample;
  JumpSample jump{percent * row.jump_max, percent * row.jump_p99, row.jump_max_pixels, row.jump_p99_pixels, {}, {}};
  if (row.step > 0) jump.per_step = row.jump_max / row.step;
  if (std::isfinite(row.jump_over_bound)) jump.over_bound = row.jump_over_bound;
  sample.jump = jump;
  return sample;
}

void add_times(Row& row, SystemPictures& pictures, LodSystem system, const std::vector<Camera>& cameras,
               const ViewConfig& view, int rounds, const RunContext& context) {
  FrameRounds times;
  double drawn = 0, triangles = 0;
  for (int round = 0; round <= rounds; ++round) {
    std::vector<StageTime> frames;
    drawn = triangles = 0;  // the same in every round
    for (const Camera& camera : cameras) {
      check_cancelled(context);
      const CpuClock clock;
      const SystemPicture picture = pictures.draw(system, camera, view);
      frames.push_back(clock.elapsed());
      drawn += picture.pictures, triangles += static_cast<double>(picture.stats.triangles);
    }
    if (round > 0) times.add(frames);  // the first one warms up
  }
  const auto count = static_cast<double>(cameras.size());
  add_frames(row, times);
  row["pictures"] = drawn / count, row["triangles"] = triangles / count;
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const auto scheduler = study_scheduler(parameters);
  const Hierarchy hierarchy = build_study_hierarchy(parameters, context, *scheduler);
  const LodSystem system = lod_system(parameters.text("system"));
  SystemFlightConfig config;
  config.view = view_of_model(view_size(parameters), parameters.integer("samples"));
  config.view.radii.pixel_error = static_cast<float>(parameters.number("pixel_error"));
  config.view.effects = effect_request(parameters);
  config.view.effects.listed.insert(Effect::geomorph);
  config.systems = {system};
  config.system.fade_width = parameters.number("fade_width");
  config.cancel = context.cancel;
  config.cameras = path_cameras(hierarchy, parameters);

  SceneView scene(scene_of("input"), {{&hierarchy}});
  const auto renderer = make_renderer(parameters.text("backend"), *scheduler);
  scene.upload(*renderer);
  Row row;
  SystemPictures pictures(scene, *renderer, config.system);
  add_times(row, pictures, system, config.cameras, config.view, parameters.integer("rounds"), context);
  row["admissible"] = system == LodSystem::morph && scene.admissible();
  if (context.repetition > 0) return {row};

  SurfaceSummary cracks_and_pops;
  PictureSummary seen;
  WorstPicture worst;
  (void)fly_systems(scene, *renderer, config, *scheduler,
                    [&](const SystemRow& frame, const SystemPicture& drawn, const Image& full) {
                      const bool follows = frame.frame > 0;
                      cracks_and_pops.add(surface_of(frame, drawn.models.front(), follows));
                      PictureSample sample{frame.quality, {}, {}};
                      if (follows) sample.pops = frame.pops, sample.flip_pops = frame.flip_pops;
                      seen.add(std::move(sample));
                      worst.offer(drawn.image, full, frame.quality.flip.mean);
                      context.progress(static_cast<double>(frame.frame) / static_cast<double>(config.cameras.size()));
                    });
  cracks_and_pops.add_to(row);
  seen.add_to(row);
  worst.write(context.directory, *scheduler);
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
  SurfaceSummary::check(verdict, true);
  PictureSummary::check(verdict);
  return std::move(verdict).messages();
}

}  // namespace

Experiment systems_experiment() {
  return {"systems", "On the same path, what cracks and what pops under which system of levels of detail?",
          true,      parameters(),
          columns(), run,
          verify,    check};
}

}  // namespace lodestone
