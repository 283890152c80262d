// lodestone render: a camera path through a scene; pictures, times, and the proof of every frame.
#include "experiments/subjects/render.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/error.h"
#include "core/mesh/up_axis.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/command_line/picture_writer.h"
#include "experiments/command_line/progress.h"
#include "experiments/command_line/sizes.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "experiments/metrics/cracks/adversary.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/make_renderer.h"
#include "render/culling/back_faces.h"
#include "render/effects/plan.h"
#include "render/scene/open_scene.h"

namespace lodestone {
namespace {

struct RenderOptions {
  InputOptions reading;
  std::string file, backend = "soft", metric = "euclidean", size = "1280x720", output;
  // Instead of what the scene says.
  std::optional<std::string> camera, blend_name, effects;
  std::optional<int> frames;
  std::optional<float> kappa0, pixel_error;
  std::optional<std::string> radii;
  int samples = 1;
  float beta = RadiiConfig{}.beta, delta = 0;
  bool allow_inadmissible = false, tint = false, no_metrics = false, explain = false, cull_occluded = false,
       cull_back_faces = false, measure_screen = false, select_on_device = false;
  Bytes memory_budget;  // 0: the whole file
};

// A tolerance that is not given is the scene's.
RadiiConfig radii_of(const RenderOptions& options, const RadiiConfig& of_scene) {
  if (options.kappa0 && options.pixel_error)
    throw UsageError("--kappa0 and --pixel-error exclude each other; give one of them");
  RadiiConfig config = radii_config(options.radii.value_or(options.kappa0 ? "per-level" : "adaptive"), options.metric);
  if (options.kappa0 && config.rule == RadiiRule::adaptive)
    throw UsageError("--radii adaptive follows from --pixel-error, not from --kappa0; leave one of them out");
  config.kappa0 = options.kappa0;
  config.pixel_error = options.pixel_error.value_or(of_scene.pixel_error);
  config.beta = options.beta;
  config.delta = options.delta;
  return config;
}

// Cameras at adversarial viewpoints, each looking at the vertex that cracks there if anything does.
std::vector<Camera> adversarial_cameras(const Hierarchy& hierarchy, const RadiiConfig& config, int frames, Vec3d up) {
  if (!config.kappa0 && config.rule != RadiiRule::adaptive)
    throw UsageError("--camera adversarial needs --kappa0 or --radii adaptive: its viewpoints are made for its radii");
  const AdversaryConfig adversary{.count = static_cast<std::size_t>(frames)};
  std::vector<Camera> cameras;
  for (const AdversarialView& view : adversarial_views(hierarchy, make_radii(hierarchy, config), adversary)) {
    Camera camera;
    camera.up = up;
    camera.position = hierarchy.transform.to_model(view.viewpoint);
    camera.target = hierarchy.transform.to_model(hierarchy.cells[view.cell].positions[view.vertex]);
    cameras.push_back(camera);
  }
  if (cameras.empty()) throw InputError(why_no_adversary(hierarchy));
  if (cameras.size() < static_cast<std::size_t>(frames))
    fmt::print("note: {} of {} frames: no more cells of this model have an adversarial viewpoint\n", cameras.size(),
               frames);
  return cameras;
}

bool is_path_file(const std::string& camera) { return !is_model_path(camera) && camera != "adversarial"; }

std::vector<FileArgument> input_files(const RenderOptions& options) {
  std::vector<FileArgument> files{{"FILE", options.file}};
  if (options.camera && is_path_file(*options.camera)) files.push_back({"--camera", *options.camera});
  return files;
}

// Applies the options that replace settings of the scene.
void apply(const RenderOptions& options, Scene& scene) {
  scene.radii = radii_of(options, scene.radii);
  if (options.blend_name) scene.blend = blend_named(*options.blend_name);
  if (options.effects) scene.effects = parse_effects(*options.effects);
  if (options.tint) scene.settings.level_tint = 1;
  if (options.frames) scene.camera.frames = *options.frames;
  if (options.camera) scene.camera.path = *options.camera;
  if (options.reading.up) scene.up = up_axis(*options.reading.up);
}

std::vector<Camera> cameras(const SceneView& view, const Hierarchy& whole, ImageSize size) {
  const Scene& scene = view.scene();
  if (scene.camera.path != "adversarial") return camera_path(view, size);
  if (view.model_count() > 1) throw InputError("--camera adversarial is made for one model; this scene has several");
  const RadiiConfig radii = for_picture(scene.radii, size, Camera{}.vertical_fov);
  return adversarial_cameras(whole, radii, scene.camera.frames, view.up());
}

void refuse_inadmissible(const RenderOptions& options, const SceneView& view) {
  for (std::size_t m = 0; m < view.model_count() && !options.allow_inadmissible; ++m) {
    const RadiiConfig& config = view.scene().radii;
    if (config.rule != RadiiRule::uniform || make_radii(view.hierarchy(m), config).admissible) continue;
    const float rho = greatest_reach(view.hierarchy(m), config.metric);
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

Json plan_json(const std::vector<PlannedEffect>& plan, const std::vector<std::string>& names) {
  Json rows = Json::array();
  for (const PlannedEffect& planned : plan) {
    Json reasons = Json::object();
    for (const auto& [model, why] : planned.reasons) reasons[names[model]] = why;
    rows.push_back({{"effect", name_of(planned.effect)}, {"runs", planned.runs}, {"reasons", reasons}});
  }
  return rows;
}

Json frame_json(const FrameResult& frame, bool streamed) {
  Json json = without_nulls(to_row(frame));
  json.update({{"milliseconds", frame.milliseconds}, {"work", frame.work}, {"drawn", frame.drawn}});
  if (frame.draw_calls > 0) json["draw_calls"] = frame.draw_calls;
  if (streamed) json.update({{"resident_bytes", frame.resident_bytes}, {"complete", frame.complete}});
  if (streamed && frame.surface && frame.surface->jump) json["jump_by_limits"] = frame.surface->jump->by_limits;
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

// A scene that is open, before a camera, and the renderer that draws it.
class Flight {
 public:
  Flight(const RenderOptions& options, const CommonOptions& common)
      : options_(options), common_(common), scheduler_(make_scheduler(common)), progress_("rendering", common.quiet) {}

  void run() {
    open();
    configure();
    const RenderResult result = fly();
    progress_.clear();
    if (common_.prints()) print_warnings(result.warnings);
    if (options_.explain && common_.json != "-") fmt::print("{}", to_text(plan_, names_of(scene_)));
    const Row row = to_row(result);
    write_result(common_, result_json(result, row));
    if (common_.prints()) print(result, row);
  }

 private:
  void open() {
    scene_ = OpenScene::read(options_.file);
    apply(options_, scene_);
    job_.measure = !common_.json.empty() && !options_.no_metrics;
    job_.measure_screen = options_.measure_screen;
    job_.cancel = &interrupt_flag();
    OpenSceneConfig opening;
    opening.memory_budget = options_.memory_budget.count;
    opening.reading = read_config(options_.reading, {options_.file});
    opening.whole_too = needs_wholes();
    opening.cancel = job_.cancel;
    opening.progress = [&](const std::string& phase, const SceneModel& model, std::optional<double> share) {
      share ? progress_.update(*share) : progress_.phase(phase + " " + model.name);
    };
    opened_.emplace(scene_, opening, *scheduler_);
    if (common_.prints()) print_warnings(opened_->warnings());
    if (streamed()) job_.measured = opened_->wholes();
    std::vector<OpenModel> models = opened_->models();
    for (OpenModel& model : models)
      if (options_.cull_back_faces) model.back_faces = &back_faces_of(*model.hierarchy);
    view_.emplace(scene_, std::move(models));
    refuse_inadmissible(options_, *view_);
  }

  const BackFaces& back_faces_of(const Hierarchy& hierarchy) {
    const auto [at, is_new] = back_faces_.try_emplace(&hierarchy, hierarchy, *scheduler_);
    const Facing facing = at->second.facing();
    if (is_new && common_.prints() && (facing == Facing::open || facing == Facing::mixed))
      fmt::print("note: --cull-back-faces leaves out nothing of a model that {}\n",
                 facing == Facing::open ? "is open" : "has parts that face outwards and others that face inwards");
    return at->second;
  }

  void configure() {
    job_.view = view_config(scene_, parse_image_size("--size", options_.size));
    job_.view.samples = options_.samples;
    job_.view.cull_occluded = options_.cull_occluded;
    job_.view.select_on_device = options_.select_on_device;
    job_.cameras = cameras(*view_, needs_wholes() ? *opened_->wholes().front() : view_->hierarchy(0), job_.view.size);
    renderer_ = renderer_or_soft(options_.backend, *scheduler_, fallback_);
    if (!fallback_.empty()) {
      progress_.clear();
      fmt::print(stderr, "lodestone: {}; drawing with soft instead\n", fallback_);
    }
  }

  RenderResult fly() {
    std::optional<PictureWriter> pictures;
    writes_ = options_.backend != "null" && !options_.output.empty();
    if (writes_) pictures.emplace(options_.output, job_.cameras.size());
    progress_.phase("rendering");
    progress_.measure(static_cast<double>(job_.cameras.size()), "frames");
    job_.on_frame = [&](std::size_t index, Renderer& renderer) {
      if (index == 0) {
        first_picture_seconds_ = clock_.elapsed().seconds;
        plan_ = explain_plan(view_->frame());
      }
      if (pictures) pictures->add(index, renderer.read_back());
      progress_.update(static_cast<double>(index + 1) / static_cast<double>(job_.cameras.size()));
    };
    RenderResult result = lodestone::run(job_, *view_, *renderer_, *scheduler_);
    if (pictures) pictures->finish();
    return result;
  }

  [[nodiscard]] Json result_json(const RenderResult& result, const Row& row) const {
    Json frames = Json::array();
    for (const FrameResult& frame : result.frames) frames.push_back(frame_json(frame, streamed()));
    Json json = without_nulls(restricted_to(without(render_columns(), round_columns), row));
    json.update({{"frames", frames},
                 {"file", options_.file},
                 {"backend", renderer_->name()},
                 {"camera", scene_.camera.path.empty() ? "keys" : scene_.camera.path},
                 {"blend", name_of(scene_.blend)},
                 {"models", names_of(scene_)},
                 {"effects", plan_json(plan_, names_of(scene_))},
                 {"metric", options_.metric},
                 {"radii", name_of(job_.view.radii.rule)},
                 {"first_picture_seconds", first_picture_seconds_},
                 {"samples", job_.view.samples},
                 {"size", {job_.view.size.width, job_.view.size.height}}});
    if (!fallback_.empty()) json["fallback"] = fallback_;
    return json;
  }

  void print(const RenderResult& result, const Row& row) const {
    if (!scene_.up) print_up_note(opened_->models().front().hierarchy->transform.up);
    fmt::print("{} frames on {}: median {:.2f} ms{}\n", result.frames.size(), renderer_->name(),
               number_in(row, "frame_ms_median").value_or(0), writes_ ? ", pictures in " + options_.output : "");
    if (job_.measure_screen)
      fmt::print("screen error at most {:.3f} pixels\n", number_in(row, "screen_error").value_or(0));
    if (job_.measure)
      fmt::print("open edges {}, largest gap {:g} % of the extent, {}\n", number_in(row, "open_edges").value_or(0),
                 number_in(row, "gap_max").value_or(0), jump_text(row));
  }

  [[nodiscard]] bool streamed() const { return options_.memory_budget.count > 0; }
  [[nodiscard]] bool needs_wholes() const {
    return job_.measure || job_.measure_screen || scene_.camera.path == "adversarial";
  }
  static std::string jump_text(const Row& row) {
    const auto pixels = number_in(row, "jump_pixels"), ratio = number_in(row, "jump_over_bound");
    if (!pixels) return "no two frames to look for jumps";
    const std::string jump = fmt::format("largest jump {:.3g} pixels at steps of {:.3g} % of the extent", *pixels,
                                         number_in(row, "viewpoint_step").value_or(0));
    if (!ratio) return jump + ", without an analytic bound";
    const double vacuous = number_in(row, "vacuous_frames").value_or(0);
    return jump + fmt::format(", at most {:.4f} of the analytic bound", *ratio) +
           (vacuous > 0 ? fmt::format(", which is vacuous in {:.3g} % of the frames (steps too long)", vacuous) : "");
  }

  // One round has neither a minimum nor a maximum.
  inline static const std::vector<std::string> round_columns{"frame_ms_min", "frame_ms_max", "frame_cpu_ms_min",
                                                             "frame_cpu_ms_max"};
  const RenderOptions& options_;
  const CommonOptions& common_;
  const CpuClock clock_;
  std::unique_ptr<Scheduler> scheduler_;
  Progress progress_;
  Scene scene_;
  RenderJob job_;
  std::optional<OpenScene> opened_;
  std::map<const Hierarchy*, BackFaces> back_faces_;
  std::optional<SceneView> view_;
  std::unique_ptr<Renderer> renderer_;
  std::string fallback_;  // why soft draws instead; empty: the backend is the one asked for
  bool writes_ = false;
  double first_picture_seconds_ = 0;
  std::vector<PlannedEffect> plan_;
};

void run(const RenderOptions& options, const CommonOptions& common) {
  check_files(common, input_files(options));
  if (options.cull_back_faces && options.memory_budget.count > 0)
    throw UsageError("--cull-back-faces needs whole models, --memory-budget loads parts of them; give one of them");
  Flight(options, common).run();
}

// Options of the scene, the camera and the pictures.
OptionTable declare_view(RenderOptions& o) {
  return {
      OptionSpec{"FILE", &o.file,
                 std::string("Hierarchy (.lode), scene (.toml), or a mesh that is built first (") + mesh_formats + ")"}
          .must(),
      {"--camera", &o.camera,
       "fly-in, orbit, walk, wander, adversarial, or a path file (.json); fly-in unless the scene says otherwise"},
      OptionSpec{"--frames", &o.frames, "Number of frames; 120 unless the scene says otherwise"}.between(1, 1e6),
      up_option(o.reading.up),
      {"--size", &o.size, "Picture size"},
      OptionSpec{"--samples", &o.samples, "Samples per pixel; 4 smooths edges"}.one_of({"1", "4"}),
      {"--backend", &o.backend, "soft, gl (soft where there is no OpenGL 4.5) or null"},
      {"--tint", &o.tint, "Colour by level"},
      {"--effects", &o.effects,
       "auto (those that the scene calls for), all, none, or names separated by commas: " + effect_list()},
      {"--explain", &o.explain, "Print which effects run, and why"},
      {"-o,--output", &o.output, "Folder for the frames and contact.png"}};
}

// Options of selection, morph and measurement.
OptionTable declare_levels(RenderOptions& o) {
  return {{"--pixel-error", &o.pixel_error, "Tolerance in pixels; 1 when neither this nor --kappa0 is given"},
          {"--kappa0", &o.kappa0, "Selection radius over cell size instead"},
          {"--radii", &o.radii,
           "adaptive (a radius for every cell, by its own error), the rule of --pixel-error; per-level (by the largest "
           "error of each level), that of --kappa0; or uniform (the published one, which is not always admissible)"},
          {"--blend", &o.blend_name,
           "linear, smoothstep, smootherstep, cosine, early, late or step; or a curve of your own: table:0,0.1,0.9,1 "
           "(values at equal distances) or polynomial:0,0,3,-2 (coefficients of 1, t, t^2, ...); smoothstep unless the "
           "scene says otherwise"},
          {"--metric", &o.metric, "euclidean or chebyshev"},
          {"--beta", &o.beta, "Minimum width of a morph band over the cell size"},
          {"--delta", &o.delta, "Guard for a selection stale by delta cell sizes"},
          {"--allow-inadmissible", &o.allow_inadmissible, "Draw although cracks are to be expected"},
          {"--memory-budget", &o.memory_budget,
           "Stream the file: load cells while drawing, coarse ones first, and keep at most this much of them (512MiB); "
           "no crack and no pop for what is missing, but frames depend on the speed of the disk"},
          {"--cull-occluded", &o.cull_occluded,
           "Leave out cells that others hide: the same pictures, sooner where much is hidden"},
          {"--select-on-device", &o.select_on_device, "Backend gl: select cells by a compute shader; the same cells"},
          {"--cull-back-faces", &o.cull_back_faces,
           "Leave out cells that turn their back, where the surface is closed and seen from outside"},
          {"--no-metrics", &o.no_metrics, "With --json: times and counts only, no cracks and pops"},
          {"--screen-error", &o.measure_screen,
           "Measure how far the drawn surface is from the full one on the screen, in pixels; seconds a frame"}};
}

OptionTable declare(RenderOptions& o) {
  OptionTable table = declare_view(o);
  for (OptionSpec& option : declare_levels(o)) table.push_back(std::move(option));
  return with_input_options(std::move(table), o.reading);
}

}  // namespace

void add_render(CommandTable& commands) {
  define_command<RenderOptions>(
      commands,
      {"render", "Draw a camera path; with --json, prove every frame free of cracks and pops",
       "  lodestone render scan.lode --camera fly-in --frames 60 -o frames\n"
       "  lodestone render experiments/scenes/museum.toml --explain -o frames\n"
       "  lodestone render city.lode --memory-budget 256MiB -o frames\n"
       "  lodestone render scan.lode --backend null --kappa0 3 --radii uniform --json proof.json\n"
       "  lodestone render scan.lode --camera adversarial --kappa0 1.5 --radii uniform "
       "--allow-inadmissible --backend null --json cracks.json\n"},
      declare, run);
}

}  // namespace lodestone
