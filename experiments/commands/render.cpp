// lodestone render: a camera path through a scene; pictures, times, and the proof of every frame.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/error.h"
#include "experiments/command_line/byte_size.h"
#include "experiments/command_line/picture_writer.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "experiments/flights/flight.h"
#include "experiments/metrics/cracks/adversary.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/make_renderer.h"
#include "render/culling/back_faces.h"
#include "render/effects/plan.h"
#include "render/scene/open_scene.h"

namespace lodestone {
namespace {

struct RenderOptions {
  std::string file, backend = "soft", radii = "per-level", metric = "euclidean", size = "1280x720", output;
  // Instead of what the scene says.
  std::optional<std::string> camera, blend_name, effects;
  std::optional<int> frames;
  std::optional<float> kappa0, pixel_error;
  int samples = 1;
  float beta = RadiiConfig{}.beta, delta = 0;
  bool allow_inadmissible = false, tint = false, no_metrics = false, explain = false, cull_occluded = false,
       cull_back_faces = false, measure_screen = false, select_on_device = false;
  std::uint64_t memory_budget = 0;  // bytes; 0: the whole file
};

ImageSize parse_size(const std::string& text) {
  ImageSize size;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &rest) != 2 || size.width < 1 ||
      size.height < 1 || size.width > 16384 || size.height > 16384)
    throw InputError("--size " + text + ": not a picture size; write WIDTHxHEIGHT, each from 1 to 16384");
  return size;
}

DistanceMetric parse_metric(const std::string& name) {
  if (name == "euclidean") return DistanceMetric::euclidean;
  if (name == "chebyshev") return DistanceMetric::chebyshev;
  throw InputError("--metric " + name + ": unknown; known are euclidean, chebyshev");
}

RadiiConfig radii_config(const RenderOptions& options, const RadiiConfig& of_scene) {
  RadiiConfig config = of_scene;
  if (options.kappa0 && options.pixel_error)
    throw InputError("--kappa0 and --pixel-error exclude each other; give one of them");
  if (options.radii != "per-level" && options.radii != "uniform")
    throw InputError("--radii " + options.radii + ": unknown; known are per-level, uniform");
  config.rule = options.radii == "uniform" ? RadiiRule::uniform : RadiiRule::per_level;
  config.metric = parse_metric(options.metric);
  config.kappa0 = options.kappa0;
  if (options.pixel_error) config.pixel_error = *options.pixel_error;
  config.beta = options.beta;
  config.delta = options.delta;
  return config;
}

// Cameras at adversarial viewpoints, each looking at the vertex that cracks there if anything does.
std::vector<Camera> adversarial_cameras(const Hierarchy& hierarchy, const RadiiConfig& config, int frames) {
  if (!config.kappa0) throw InputError("--camera adversarial needs --kappa0: its viewpoints are made for one");
  AdversaryConfig adversary;
  adversary.per_level = static_cast<std::size_t>(frames) / static_cast<std::size_t>(hierarchy.levels.size()) + 1;
  std::vector<Camera> cameras;
  for (const AdversarialView& view : adversarial_views(hierarchy, make_radii(hierarchy, config), adversary)) {
    Camera camera;
    camera.position = hierarchy.transform.to_model(view.viewpoint);
    camera.target = hierarchy.transform.to_model(hierarchy.cells[view.cell].positions[view.vertex]);
    cameras.push_back(camera);
  }
  if (cameras.empty()) throw InputError("no vertex of this hierarchy is shared between cells: it cannot crack");
  if (cameras.size() > static_cast<std::size_t>(frames)) cameras.resize(static_cast<std::size_t>(frames));
  return cameras;
}

bool is_path_file(const std::string& camera) {
  return camera != "orbit" && camera != "fly-in" && camera != "adversarial";
}

std::vector<FileArgument> input_files(const RenderOptions& options) {
  std::vector<FileArgument> files{{"FILE", options.file}};
  if (options.camera && is_path_file(*options.camera)) files.push_back({"--camera", *options.camera});
  return files;
}

// What the options change of the scene.
void apply(const RenderOptions& options, Scene& scene) {
  scene.radii = radii_config(options, scene.radii);
  if (options.blend_name) scene.blend = blend(*options.blend_name);
  if (options.effects) scene.effects = parse_effects(*options.effects);
  if (options.tint) scene.settings.level_tint = 1;
  if (options.frames) scene.camera.frames = *options.frames;
  if (options.camera) scene.camera.path = *options.camera;
}

std::vector<Camera> cameras(const SceneView& view, const Hierarchy& whole) {
  const Scene& scene = view.scene();
  if (scene.camera.path != "adversarial") return camera_path(view);
  if (view.model_count() > 1) throw InputError("--camera adversarial is made for one model; this scene has several");
  return adversarial_cameras(whole, scene.radii, scene.camera.frames);
}

void refuse_inadmissible(const RenderOptions& options, const SceneView& view) {
  for (std::size_t m = 0; m < view.model_count() && !options.allow_inadmissible; ++m) {
    const RadiiConfig& config = view.scene().radii;
    if (make_radii(view.hierarchy(m), config).admissible) continue;
    const float rho = reach(view.hierarchy(m), config.metric);
    throw InputError(describe(
        view.model_count() > 1 ? view.scene().models[m].name : options.file, "",
        fmt::format("kappa0 = {} is inadmissible here: it must exceed {:.4f}", *config.kappa0, rho + 3 * config.delta),
        "raise it, use --radii per-level, or see it crack with --allow-inadmissible"));
  }
}

std::vector<std::string> names_of(const Scene& scene) {
  std::vector<std::string> names;
  for (const SceneModel& model : scene.models) names.push_back(model.name);
  return names;
}

nlohmann::json to_json(const std::vector<PlannedEffect>& plan, const std::vector<std::string>& names) {
  nlohmann::json rows = nlohmann::json::array();
  for (const PlannedEffect& planned : plan) {
    nlohmann::json reasons = nlohmann::json::object();
    for (const auto& [model, why] : planned.reasons) reasons[names[model]] = why;
    rows.push_back({{"effect", name_of(planned.effect)}, {"runs", planned.runs}, {"reasons", reasons}});
  }
  return rows;
}

nlohmann::json to_json(const FlightResult& result, bool measured, bool streamed) {
  nlohmann::json frames = nlohmann::json::array();
  for (const FrameRow& row : result.frames) {
    nlohmann::json frame{{"cells", row.cells}, {"triangles", row.triangles}, {"milliseconds", row.milliseconds}};
    frame.update({{"work", row.work}, {"drawn", row.drawn}});
    if (row.draw_calls > 0) frame["draw_calls"] = row.draw_calls;
    if (row.screen_error > 0) frame["screen_error"] = row.screen_error;
    if (streamed) frame.update({{"resident_bytes", row.resident_bytes}, {"complete", row.complete}});
    if (measured)
      frame.update({{"selected_triangles", row.selected_triangles},
                    {"open_edges", row.open_edges},
                    {"gap_max", row.gap_max},
                    {"max_jump", row.max_jump},
                    {"jump_over_bound", row.jump_over_bound}});
    frames.push_back(std::move(frame));
  }
  nlohmann::json json{
      {"admissible", result.admissible}, {"frames", frames}, {"milliseconds_median", result.milliseconds_median}};
  if (result.screen_error_max > 0) json["screen_error_max"] = result.screen_error_max;
  if (measured) {
    json["cracks"] = {{"open_edges_max", result.open_edges_max}, {"gap_max", result.gap_max}};
    json["pops"] = {{"jump_over_bound_max", result.jump_over_bound_max}};
  }
  return json;
}

// The backend asked for, or soft where this machine has no OpenGL; `why` says then what is missing.
std::unique_ptr<Renderer> renderer_or_soft(const std::string& backend, Scheduler& scheduler, std::string& why) {
  try {
    return make_renderer(backend, scheduler);
  } catch (const UnsupportedError& error) {
    if (backend != "gl") throw;
    why = error.what();
    return make_renderer("soft", scheduler);
  }
}

void run(const RenderOptions& options, const CommonOptions& common) {
  check_files(common, input_files(options));
  const CpuClock clock;
  Scene scene = OpenScene::read(options.file);
  apply(options, scene);
  FlightConfig config;
  config.view = view_config(scene, parse_size(options.size));
  config.view.samples = options.samples;
  config.view.cull_occluded = options.cull_occluded;
  config.view.select_on_device = options.select_on_device;
  if (options.cull_back_faces && options.memory_budget > 0)
    throw InputError("--cull-back-faces looks at whole models, --memory-budget at parts of them; give one of them");
  config.measure = !common.json.empty() && !options.no_metrics;
  config.cancel = &interrupt_flag();

  const auto scheduler = make_scheduler(common);
  Progress progress("rendering", common.quiet);
  config.measure_screen = options.measure_screen;
  const bool needs_wholes = config.measure || config.measure_screen || scene.camera.path == "adversarial";
  OpenSceneConfig opening;
  opening.memory_budget = options.memory_budget;
  opening.whole_too = needs_wholes;
  opening.cancel = config.cancel;
  opening.progress = [&](const std::string& phase, const SceneModel& model, std::optional<double> share) {
    share ? progress.update(*share) : progress.phase(phase + " " + model.name);
  };
  const OpenScene opened(scene, opening, *scheduler);
  if (!common.quiet && common.json != "-") print_warnings(opened.warnings());
  if (options.memory_budget > 0) config.measured = opened.wholes();
  std::vector<OpenModel> models = opened.models();
  std::map<const Hierarchy*, BackFaces> back_faces;
  for (OpenModel& model : models)
    if (options.cull_back_faces)
      model.back_faces = &back_faces.try_emplace(model.hierarchy, *model.hierarchy, *scheduler).first->second;
  SceneView view(scene, std::move(models));
  refuse_inadmissible(options, view);
  config.cameras = cameras(view, needs_wholes ? *opened.wholes().front() : view.hierarchy(0));
  std::string fallback;
  const auto renderer = renderer_or_soft(options.backend, *scheduler, fallback);
  if (!fallback.empty()) {
    progress.clear();
    fmt::print(stderr, "lodestone: {}; drawing with soft instead\n", fallback);
  }
  std::optional<PictureWriter> pictures;
  const bool draws = options.backend != "null";
  if (draws && !options.output.empty()) pictures.emplace(options.output, config.cameras.size());

  progress.phase("rendering");
  progress.measure(static_cast<double>(config.cameras.size()), "frames");
  double first_picture = 0;
  std::vector<PlannedEffect> plan;
  const FlightResult result = fly(view, *renderer, config, *scheduler, [&](std::size_t index, Renderer& r) {
    if (index == 0) {
      first_picture = clock.elapsed().seconds;
      plan = explain_plan(view.frame());
    }
    if (pictures) pictures->add(index, r.read_back());
    progress.update(static_cast<double>(index + 1) / static_cast<double>(config.cameras.size()));
  });
  if (pictures) pictures->finish();
  progress.clear();
  if (!common.quiet && common.json != "-") print_warnings(result.warnings);
  if (options.explain && common.json != "-") fmt::print("{}", to_text(plan, names_of(scene)));

  nlohmann::json json = to_json(result, config.measure, options.memory_budget > 0);
  json.update({{"file", options.file},
               {"backend", renderer->name()},
               {"camera", scene.camera.path.empty() ? "keys" : scene.camera.path},
               {"blend", name_of(scene.blend)},
               {"models", names_of(scene)},
               {"effects", to_json(plan, names_of(scene))},
               {"metric", options.metric},
               {"radii", options.radii},
               {"first_picture_seconds", first_picture},
               {"samples", config.view.samples},
               {"size", {config.view.size.width, config.view.size.height}}});
  if (!fallback.empty()) json["fallback"] = fallback;
  write_json(common, json);
  if (common.quiet || common.json == "-") return;
  fmt::print("{} frames on {}: median {:.2f} ms{}\n", result.frames.size(), renderer->name(),
             result.milliseconds_median, pictures ? ", pictures in " + options.output : "");
  if (config.measure_screen) fmt::print("screen error {:.3f} pixels at most\n", result.screen_error_max);
  if (config.measure)
    fmt::print("open edges {}, largest gap {:g}, largest jump {:.4f} of the analytic bound\n", result.open_edges_max,
               result.gap_max, result.jump_over_bound_max);
}

}  // namespace

void add_render(CLI::App& app) {
  const auto common = std::make_shared<CommonOptions>();
  const auto options = std::make_shared<RenderOptions>();
  CLI::App& command =
      add_command(app, "render", "Draw a camera path; with --json, prove every frame free of cracks and pops",
                  "  lodestone render scan.lode --camera fly-in --frames 60 -o frames\n"
                  "  lodestone render experiments/scenes/museum.toml --explain -o frames\n"
                  "  lodestone render city.lode --memory-budget 256MiB -o frames\n"
                  "  lodestone render scan.lode --backend null --kappa0 3 --radii uniform --json proof.json\n"
                  "  lodestone render scan.lode --camera adversarial --kappa0 1.5 --radii uniform "
                  "--allow-inadmissible --backend null --json cracks.json\n",
                  common);
  command
      .add_option("FILE", options->file,
                  std::string("Hierarchy (.lode), scene (.toml), or a mesh that is built first (") + mesh_formats + ")")
      ->required();
  command.add_option("--camera", options->camera,
                     "fly-in, orbit, adversarial, or a path file (.json); fly-in unless the scene says otherwise");
  command.add_option("--frames", options->frames, "Number of frames; 120 unless the scene says otherwise")
      ->check(CLI::Range(1, 1'000'000));
  command.add_option("--size", options->size, "Picture size")->capture_default_str();
  command.add_option("--samples", options->samples, "Samples a pixel; 4 smooths edges")
      ->check(CLI::IsMember({1, 4}))
      ->capture_default_str();
  command.add_option("--backend", options->backend, "soft, gl (soft where there is no OpenGL 4.5) or null")
      ->capture_default_str();
  command.add_option("--pixel-error", options->pixel_error,
                     "Tolerance in pixels; 1 when neither this nor --kappa0 is given");
  command.add_option("--kappa0", options->kappa0, "Selection radius over cell size instead");
  command.add_option("--radii", options->radii, "per-level (always admissible) or uniform (the published rule)")
      ->capture_default_str();
  command.add_option(
      "--blend", options->blend_name,
      "linear, smoothstep, smootherstep, cosine, early, late or step; smoothstep unless the scene says otherwise");
  command.add_option("--metric", options->metric, "euclidean or chebyshev")->capture_default_str();
  command.add_option("--beta", options->beta, "Least width of a morph band over the cell size")->capture_default_str();
  command.add_option("--delta", options->delta, "Guard for a selection stale by delta cell sizes")
      ->capture_default_str();
  command.add_flag("--allow-inadmissible", options->allow_inadmissible, "Draw although cracks are to be expected");
  command.add_flag("--tint", options->tint, "Colour by level");
  command.add_option(
      "--effects", options->effects,
      "auto (those that the scene calls for), all, none, or names separated by commas: " + effect_list());
  command.add_flag("--explain", options->explain, "Print which effects run, and why");
  command
      .add_option(
          "--memory-budget", options->memory_budget,
          "Stream the file: load cells while drawing, coarse ones first, and keep so many bytes of them at most "
          "(512MiB); no crack and no pop for what is missing, but frames depend on the speed of the disk")
      ->transform(byte_size())
      ->type_name("BYTES");
  command.add_flag("--cull-occluded", options->cull_occluded,
                   "Leave out cells that others hide: the same pictures, sooner where much is hidden");
  command.add_flag("--select-on-device", options->select_on_device,
                   "Backend gl: select cells by a compute shader; the same cells");
  command.add_flag("--cull-back-faces", options->cull_back_faces,
                   "Leave out cells that turn their back, where the surface is closed and seen from outside");
  command.add_flag("--no-metrics", options->no_metrics, "With --json: times and counts only, no cracks and pops");
  command.add_flag("--screen-error", options->measure_screen,
                   "Measure how far the drawn surface is from the full one on the screen, in pixels; seconds a frame");
  command.add_option("-o,--output", options->output, "Folder for the frames and contact.png");
  command.callback([options, common] { run(*options, *common); });
}

}  // namespace lodestone
