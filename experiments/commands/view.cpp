// lodestone view: a window onto a hierarchy, or onto a mesh that is built for it.
#include <fmt/core.h>

#include "core/base/error.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/command_line/sizes.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "experiments/subjects/render.h"
#include "render/backends/make_renderer.h"
#include "render/viewer/viewer.h"

namespace lodestone {
namespace {

struct ViewOptions {
  std::vector<std::string> files;
  std::string camera, backend = "auto", size = "1280x720", folder = ".";
  Bytes memory_budget;
  InputOptions reading;
  viewer::ViewSettings settings;
  std::optional<float> kappa0;
  std::optional<std::string> radii;
  std::string blend_name = "smoothstep", metric = "euclidean";
};

std::vector<std::string> backends() {
  std::vector<std::string> names = picture_backend_names();
  names.insert(names.begin(), "auto");
  return names;
}

viewer::ViewState first_state(const ViewOptions& options) {
  viewer::ViewState state;
  viewer::ViewSettings settings = options.settings;
  settings.by_kappa0 = options.kappa0.has_value();
  if (options.kappa0) settings.kappa0 = *options.kappa0;
  const RadiiConfig radii =
      radii_config(options.radii.value_or(options.kappa0 ? "per-level" : "adaptive"), options.metric);
  if (options.kappa0 && radii.rule == RadiiRule::adaptive)
    throw UsageError("--radii adaptive follows from --pixel-error, not from --kappa0; leave one of them out");
  settings.rule = radii.rule;
  settings.blend = blend_named(options.blend_name);
  state.metric = radii.metric;
  // Out of range is an error here, where a user wrote it; in the window it is brought into range.
  if (viewer::clamped(settings) != settings)
    throw UsageError("--pixel-error must lie between 0.05 and 1000, --kappa0 between 0.01 and 1000");
  state.settings = {settings, settings};
  return state;
}

void run(const ViewOptions& options, const CommonOptions& common) {
  std::vector<FileArgument> inputs;
  for (const std::string& file : options.files) inputs.push_back({"FILE", file});
  if (!options.camera.empty()) inputs.push_back({"--camera", options.camera});
  check_files(common, inputs);
  viewer::ViewerConfig config;
  if (options.memory_budget.count > 0) config.load.memory_budget = options.memory_budget.count;
  config.load.paths.assign(options.files.begin(), options.files.end());
  config.load.threads = common.threads;
  config.load.reading = read_config(options.reading, options.files);
  config.backend = options.backend;
  config.size = parse_image_size("--size", options.size);
  config.state = first_state(options);
  config.folder = options.folder;
  if (!options.camera.empty()) config.path = read_camera_keys(options.camera, {});
  config.cancel = &interrupt_flag();
  if (!common.quiet) config.say = [](const std::string& line) { fmt::print(stderr, "lodestone: {}\n", line); };

  const auto scheduler = make_scheduler(common);
  const viewer::ViewerResult result = viewer::run_viewer(config, *scheduler);
  const auto array = [](Vec3d v) { return Json::array({v.x, v.y, v.z}); };
  write_result(common,
               {{"backend", result.backend},
                {"device", result.device},
                {"camera", {{"position", array(result.camera.position)}, {"target", array(result.camera.target)}}},
                {"resident_bytes", result.resident_bytes},
                {"complete", result.complete},
                {"uploads", result.uploads},
                {"selections", result.selections},
                {"draws", result.draws},
                {"window_frames", result.window_frames},
                {"files", result.files}});
}

OptionTable declare(ViewOptions& o) {
  return with_input_options(
      {{"FILE", &o.files,
        std::string("Scene (.toml), or hierarchies (.lode) and meshes, shown together (") + mesh_formats +
            "); none waits for files to be dropped"},
       {"--size", &o.size, "Size of the window, in pixels"},
       OptionSpec{"--backend", &o.backend,
                  "soft, gl, or auto: gl on a graphics card, soft where a processor would do its work"}
           .one_of(backends()),
       up_option(o.reading.up),
       {"--camera", &o.camera, "A path file (.json): the camera is at its beginning, P plays it"},
       {"--pixel-error", &o.settings.pixel_error, "Tolerance in pixels"},
       {"--kappa0", &o.kappa0, "Selection radius over cell size instead"},
       OptionSpec{"--radii", &o.radii,
                  "adaptive (a radius for every cell, by its own error), the rule of --pixel-error; per-level, that of "
                  "--kappa0; or uniform (the published one, of kappa0)"}
           .one_of({"adaptive", "per-level", "uniform"}),
       {"--blend", &o.blend_name,
        "linear, smoothstep, smootherstep, cosine, early, late or step; or a curve of your own, as for render"},
       OptionSpec{"--metric", &o.metric, "euclidean or chebyshev"}.one_of({"euclidean", "chebyshev"}),
       OptionSpec{"--samples", &o.settings.samples, "Samples per pixel; 4 smooths edges"}.one_of({"1", "4"}),
       {"--tint", &o.settings.tint, "Colour by level"},
       {"--memory-budget", &o.memory_budget,
        "Stream files that take more than this in memory, such as 2GiB: cells load while they are looked at"},
       {"-o,--output", &o.folder, "Folder for screenshots and recorded paths"}},
      o.reading);
}

}  // namespace

void add_view(CommandTable& commands) {
  define_command<ViewOptions>(
      commands,
      {"view", "Look at a model in a window; a mesh is built for it, in memory",
       "  lodestone view scan.lode\n"
       "  lodestone view scan.ply --size 1600x900\n"
       "  lodestone view experiments/scenes/museum.toml\n"
       "  lodestone view city.lode --memory-budget 512MiB\n"
       "  lodestone view scan.lode --camera path.json --pixel-error 2\n"
       "In the window: left button orbits, right one pans, wheel zooms, a double click focuses; the panel "
       "names the keys.\n"},
      declare, run);
}

}  // namespace lodestone
