// lodestone render: a camera path over a hierarchy; pictures, times, and the proof of every frame.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "core/base/error.h"
#include "experiments/commands/command.h"
#include "experiments/flight.h"
#include "experiments/metrics/adversary.h"
#include "experiments/progress.h"
#include "parallel/cell_stream.h"
#include "parallel/cpu_clock.h"
#include "parallel/save.h"
#include "render/image.h"
#include "render/lod/resident_cells.h"

namespace lodestone {
namespace {

struct RenderOptions {
  std::string file, camera = "fly-in", backend = "soft", blend_name = "smoothstep", radii = "per-level",
                    metric = "euclidean", size = "1280x720", output;
  int frames = 120, samples = 1;
  std::optional<float> kappa0, pixel_error;
  float beta = RadiiConfig{}.beta, delta = 0;
  bool allow_inadmissible = false, tint = false, no_metrics = false;
  std::uint64_t memory_budget = 0;  // bytes; 0: the whole file
};

// The model: the whole file, or what is there of it.
struct Model {
  std::optional<CellStream> stream;
  std::optional<ResidentCells> resident;
  std::optional<Hierarchy> whole;
  [[nodiscard]] const Hierarchy& hierarchy() const { return whole ? *whole : resident->hierarchy(); }
};

// A streamed model is measured on the whole one, and adversarial viewpoints need all of its vertices.
void open_model(const RenderOptions& options, bool measured, Scheduler& scheduler, Model& model) {
  if (options.memory_budget > 0) {
    model.stream.emplace(options.file);
    model.resident.emplace(*model.stream, ResidencyConfig{.budget_bytes = options.memory_budget});
  }
  if (!model.resident || measured || options.camera == "adversarial")
    model.whole.emplace(load_lode(options.file, scheduler));
}

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

RadiiConfig radii_config(const RenderOptions& options) {
  RadiiConfig config;
  if (options.kappa0 && options.pixel_error)
    throw InputError("--kappa0 and --pixel-error exclude each other; give one of them");
  if (options.radii != "per-level" && options.radii != "uniform")
    throw InputError("--radii " + options.radii + ": unknown; known are per-level, uniform");
  config.rule = options.radii == "uniform" ? RadiiRule::uniform : RadiiRule::per_level;
  config.metric = parse_metric(options.metric);
  config.kappa0 = options.kappa0;
  config.pixel_error = options.pixel_error.value_or(1.0f);
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
  if (is_path_file(options.camera)) files.push_back({"--camera", options.camera});
  return files;
}

std::vector<Camera> cameras(const RenderOptions& options, const Hierarchy& hierarchy, const RadiiConfig& config) {
  if (options.camera == "orbit") return orbit_path(hierarchy, options.frames);
  if (options.camera == "fly-in") return fly_in_path(hierarchy, options.frames);
  if (options.camera == "adversarial") return adversarial_cameras(hierarchy, config, options.frames);
  return read_camera_path(options.camera, options.frames);
}

void refuse_inadmissible(const RenderOptions& options, const Hierarchy& hierarchy, const RadiiConfig& config) {
  if (options.allow_inadmissible || make_radii(hierarchy, config).admissible) return;
  const float rho = reach(hierarchy, config.metric);
  throw InputError(describe(
      options.file, "",
      fmt::format("kappa0 = {} is inadmissible here: it must exceed {:.4f}", *config.kappa0, rho + 3 * config.delta),
      "raise it, use --radii per-level, or see it crack with --allow-inadmissible"));
}

nlohmann::json to_json(const FlightResult& result, bool measured, bool streamed) {
  nlohmann::json frames = nlohmann::json::array();
  for (const FrameRow& row : result.frames) {
    nlohmann::json frame{{"cells", row.cells}, {"triangles", row.triangles}, {"milliseconds", row.milliseconds}};
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
  if (measured) {
    json["cracks"] = {{"open_edges_max", result.open_edges_max}, {"gap_max", result.gap_max}};
    json["pops"] = {{"jump_over_bound_max", result.jump_over_bound_max}};
  }
  return json;
}

// The frames on disk, and a sheet of some of them. Unless finish() is reached, the frames are removed again: a folder
// holds a whole flight or nothing of it.
class PictureWriter {
 public:
  PictureWriter(std::string folder, std::size_t frames) : folder_(std::move(folder)), frames_(frames) {
    std::error_code error;
    created_ = std::filesystem::create_directories(folder_, error);
    if (error)
      throw FileError(
          describe(folder_, "", "cannot create the folder: " + error.message(), "name a folder you may write to"));
  }
  PictureWriter(const PictureWriter&) = delete;
  PictureWriter& operator=(const PictureWriter&) = delete;

  ~PictureWriter() {
    if (finished_) return;
    std::error_code ignored;
    for (const std::string& file : written_) std::filesystem::remove(file, ignored);
    if (created_) std::filesystem::remove(folder_, ignored);
  }

  void operator()(std::size_t index, Renderer& renderer) {
    Image image = renderer.read_back();
    if (image.rgba.empty()) return;
    const std::string file = fmt::format("{}/frame{:04}.png", folder_, index);
    write_png(file, image);
    written_.push_back(file);
    constexpr std::size_t on_sheet = 12;
    const std::size_t steps = std::min(frames_, on_sheet);
    if (sheet_.size() < steps && index * (steps - 1) >= sheet_.size() * (frames_ - 1))
      sheet_.push_back(std::move(image));
  }

  void finish() {
    if (!sheet_.empty()) write_png(folder_ + "/contact.png", contact_sheet(sheet_));
    finished_ = true;
  }

 private:
  std::string folder_;
  std::size_t frames_;
  std::vector<Image> sheet_;
  std::vector<std::string> written_;
  bool created_ = false, finished_ = false;
};

void run(const RenderOptions& options, const CommonOptions& common) {
  FlightConfig config;
  config.radii = radii_config(options);
  config.blend = blend(options.blend_name);
  config.size = parse_size(options.size);
  config.samples = options.samples;
  config.tint_by_level = options.tint;
  config.measure = !common.json.empty() && !options.no_metrics;
  config.cancel = &interrupt_flag();
  check_files(common, input_files(options));

  const CpuClock opening;
  const auto scheduler = make_scheduler(common);
  Model model;
  open_model(options, config.measure, *scheduler, model);
  const Hierarchy& hierarchy = model.hierarchy();
  config.resident = model.resident ? &*model.resident : nullptr;
  refuse_inadmissible(options, hierarchy, config.radii);
  config.cameras = cameras(options, hierarchy, config.radii);
  const auto renderer = make_renderer(options.backend, *scheduler);
  std::optional<PictureWriter> pictures;
  const bool draws = options.backend != "null";
  if (draws && !options.output.empty()) pictures.emplace(options.output, config.cameras.size());

  Progress progress("rendering", common.quiet);
  progress.measure(static_cast<double>(config.cameras.size()), "frames");
  double first_picture = 0;
  const FlightResult result = fly(hierarchy, *renderer, config, *scheduler, [&](std::size_t index, Renderer& r) {
    if (index == 0) first_picture = opening.elapsed().seconds;
    if (pictures) (*pictures)(index, r);
    progress.update(static_cast<double>(index + 1) / static_cast<double>(config.cameras.size()));
  });
  if (pictures) pictures->finish();
  progress.clear();

  nlohmann::json json = to_json(result, config.measure, model.resident.has_value());
  json.update({{"file", options.file},
               {"backend", renderer->name()},
               {"camera", options.camera},
               {"blend", options.blend_name},
               {"metric", options.metric},
               {"radii", options.radii},
               {"first_picture_seconds", first_picture},
               {"samples", config.samples},
               {"size", {config.size.width, config.size.height}}});
  write_json(common, json);
  if (common.quiet || common.json == "-") return;
  fmt::print("{} frames on {}: median {:.2f} ms{}\n", result.frames.size(), renderer->name(),
             result.milliseconds_median, pictures ? ", pictures in " + options.output : "");
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
                  "  lodestone render city.lode --memory-budget 256MiB -o frames\n"
                  "  lodestone render scan.lode --backend null --kappa0 3 --radii uniform --json proof.json\n"
                  "  lodestone render scan.lode --camera adversarial --kappa0 1.5 --radii uniform "
                  "--allow-inadmissible --backend null --json cracks.json\n",
                  common);
  command.add_option("FILE", options->file, "Hierarchy (.lode)")->required();
  command.add_option("--camera", options->camera, "fly-in, orbit, adversarial, or a path file (.json)")
      ->capture_default_str();
  command.add_option("--frames", options->frames, "Number of frames")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command.add_option("--size", options->size, "Picture size")->capture_default_str();
  command.add_option("--samples", options->samples, "Samples a pixel; 4 smooths edges")
      ->check(CLI::IsMember({1, 4}))
      ->capture_default_str();
  command.add_option("--backend", options->backend, "soft, gl or null")->capture_default_str();
  command.add_option("--pixel-error", options->pixel_error,
                     "Tolerance in pixels; 1 when neither this nor --kappa0 is given");
  command.add_option("--kappa0", options->kappa0, "Selection radius over cell size instead");
  command.add_option("--radii", options->radii, "per-level (always admissible) or uniform (the published rule)")
      ->capture_default_str();
  command.add_option("--blend", options->blend_name, "linear, smoothstep, smootherstep, cosine, early, late or step")
      ->capture_default_str();
  command.add_option("--metric", options->metric, "euclidean or chebyshev")->capture_default_str();
  command.add_option("--beta", options->beta, "Least width of a morph band over the cell size")->capture_default_str();
  command.add_option("--delta", options->delta, "Guard for a selection stale by delta cell sizes")
      ->capture_default_str();
  command.add_flag("--allow-inadmissible", options->allow_inadmissible, "Draw although cracks are to be expected");
  command.add_flag("--tint", options->tint, "Colour by level");
  command
      .add_option(
          "--memory-budget", options->memory_budget,
          "Stream the file: load cells while drawing, coarse ones first, and keep so many bytes of them at most "
          "(512MiB); no crack and no pop for what is missing, but frames depend on the speed of the disk")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("BYTES");
  command.add_flag("--no-metrics", options->no_metrics, "With --json: times and counts only, no cracks and pops");
  command.add_option("-o,--output", options->output, "Folder for the frames and contact.png");
  command.callback([options, common] { run(*options, *common); });
}

}  // namespace lodestone
