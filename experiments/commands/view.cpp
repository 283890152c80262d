// lodestone view: a window onto a hierarchy, or onto a mesh that is built for it.
#include <fmt/core.h>

#include <cstdio>

#include "core/base/error.h"
#include "experiments/command_line/byte_size.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "render/viewer/viewer.h"

namespace lodestone {
namespace {

struct ViewOptions {
  std::vector<std::string> files;
  std::string camera, backend = "auto", size = "1280x720", folder = ".";
  InputOptions reading;
  viewer::ViewerConfig config;
  viewer::ViewSettings settings;
  std::optional<float> kappa0;
  std::string radii = "per-level", blend_name = "smoothstep", metric = "euclidean";
};

ImageSize window_size(const std::string& text) {
  ImageSize size;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &rest) != 2 || size.width < 1 ||
      size.height < 1 || size.width > 16384 || size.height > 16384)
    throw InputError("--size " + text + ": not the size of a window; write WIDTHxHEIGHT, each from 1 to 16384");
  return size;
}

viewer::ViewState first_state(const ViewOptions& options) {
  viewer::ViewState state;
  viewer::ViewSettings settings = options.settings;
  settings.by_kappa0 = options.kappa0.has_value();
  if (options.kappa0) settings.kappa0 = *options.kappa0;
  settings.rule = options.radii == "uniform" ? RadiiRule::uniform : RadiiRule::per_level;
  settings.blend = blend(options.blend_name);
  state.metric = options.metric == "chebyshev" ? DistanceMetric::chebyshev : DistanceMetric::euclidean;
  // Out of range is an error here, where a user wrote it; in the window it is brought into range.
  if (viewer::clamped(settings) != settings)
    throw InputError("--pixel-error must lie between 0.05 and 1000, --kappa0 between 0.01 and 1000");
  state.settings = {settings, settings};
  return state;
}

void run(const ViewOptions& options, const CommonOptions& common) {
  std::vector<FileArgument> inputs;
  for (const std::string& file : options.files) inputs.push_back({"FILE", file});
  if (!options.camera.empty()) inputs.push_back({"--camera", options.camera});
  check_files(common, inputs);
  viewer::ViewerConfig config = options.config;
  config.load.paths.assign(options.files.begin(), options.files.end());
  config.load.threads = common.threads;
  config.load.reading = read_config(options.reading, options.files);
  config.backend = options.backend;
  config.size = window_size(options.size);
  config.state = first_state(options);
  config.folder = options.folder;
  if (!options.camera.empty()) config.path = read_camera_keys(options.camera);
  config.cancel = &interrupt_flag();
  if (!common.quiet) config.say = [](const std::string& line) { fmt::print(stderr, "lodestone: {}\n", line); };

  const auto scheduler = make_scheduler(common);
  const viewer::ViewerResult result = viewer::run_viewer(config, *scheduler);
  const auto array = [](Vec3d v) { return nlohmann::json::array({v.x, v.y, v.z}); };
  write_json(common,
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

}  // namespace

void add_view(CLI::App& app) {
  const auto common = std::make_shared<CommonOptions>();
  const auto options = std::make_shared<ViewOptions>();
  CLI::App& command =
      add_command(app, "view", "Look at a model in a window; a mesh is built for it, in memory",
                  "  lodestone view scan.lode\n"
                  "  lodestone view scan.ply --size 1600x900\n"
                  "  lodestone view experiments/scenes/museum.toml\n"
                  "  lodestone view city.lode --memory-budget 512MiB\n"
                  "  lodestone view scan.lode --camera path.json --pixel-error 2\n"
                  "In the window: left button orbits, right one pans, wheel zooms, a double click focuses; the panel "
                  "names the keys.\n",
                  common);
  command.add_option("FILE", options->files,
                     std::string("Scene (.toml), or hierarchies (.lode) and meshes, shown together (") + mesh_formats +
                         "); none waits for files to be dropped");
  add_input_options(command, options->reading);
  command.add_option("--size", options->size, "Of the window, in pixels")->capture_default_str();
  command
      .add_option("--backend", options->backend,
                  "soft, gl, or auto: gl on a graphics card, soft where a processor would do its work")
      ->check(CLI::IsMember({"auto", "soft", "gl"}))
      ->capture_default_str();
  command.add_option("--camera", options->camera,
                     "A path file (.json): the camera stands at its beginning, P plays it");
  command.add_option("--pixel-error", options->settings.pixel_error, "Tolerance in pixels")->capture_default_str();
  command.add_option("--kappa0", options->kappa0, "Selection radius over cell size instead");
  command.add_option("--radii", options->radii, "per-level (always admissible) or uniform (the published rule)")
      ->check(CLI::IsMember({"per-level", "uniform"}))
      ->capture_default_str();
  command.add_option("--blend", options->blend_name, "linear, smoothstep, smootherstep, cosine, early, late or step")
      ->capture_default_str();
  command.add_option("--metric", options->metric, "euclidean or chebyshev")
      ->check(CLI::IsMember({"euclidean", "chebyshev"}))
      ->capture_default_str();
  command.add_option("--samples", options->settings.samples, "Samples a pixel; 4 smooths edges")
      ->check(CLI::IsMember({1, 4}))
      ->capture_default_str();
  command.add_flag("--tint", options->settings.tint, "Colour by level");
  command
      .add_option("--memory-budget", options->config.load.memory_budget,
                  "Stream files that take more than this in memory: cells load while they are looked at (2GiB)")
      ->transform(byte_size())
      ->type_name("BYTES");
  command.add_option("-o,--output", options->folder, "Folder for screenshots and recorded paths")
      ->capture_default_str();
  command.callback([options, common] { run(*options, *common); });
}

}  // namespace lodestone
