// lodestone reconstruct: LOD meshes from rendered position maps.
#include "render/reconstruct/reconstruct.h"

#include <fmt/core.h>

#include <filesystem>
#include <optional>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/mesh/raw_mesh.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/metrics/geometry/mesh_quality.h"
#include "experiments/metrics/geometry/surface_coverage.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/compare.h"
#include "parallel/mesh/load.h"
#include "parallel/scheduler/clock.h"
#include "render/position_map/map_files.h"
#include "render/reconstruct/finish/resample_attributes.h"

namespace lodestone {
namespace {

struct ReconstructOptions {
  std::string input, output, maps;
  InputOptions reading;
  std::string views = "auto", merge = "stitch", projection = "orthographic";
  ReconstructConfig config;
  double distance = 0;
  std::uint64_t triangles = 0;
  int levels = 1;
  bool measure = false;
  std::string map_format = "exr";
};

ViewChoice view_choice(const std::string& text) {
  ViewChoice choice;
  if (text == "auto") return choice;
  choice.inside = 0;
  if (text == "faces") {
    choice.most = choice.least = 6;
    return choice;
  }
  if (text.empty() || text.size() > 3 || text.find_first_not_of("0123456789") != std::string::npos ||
      std::stoi(text) < 1)
    throw InputError("--views: '" + text + "' is none of faces, auto or a number from 1 to 999");
  choice.most = choice.least = std::stoi(text);
  return choice;
}

ReconstructConfig config_of(const ReconstructOptions& options) {
  ReconstructConfig config = options.config;
  config.views = view_choice(options.views);
  if (options.merge != "stitch" && options.merge != "concatenate")
    throw InputError("--merge: '" + options.merge + "' is neither stitch nor concatenate");
  config.merge = options.merge == "stitch" ? MergeKind::stitch : MergeKind::concatenate;
  if (options.projection != "orthographic" && options.projection != "perspective")
    throw InputError("--projection: '" + options.projection + "' is neither orthographic nor perspective");
  if (options.map_format != "exr" && options.map_format != "pfm")
    throw InputError("--map-format: '" + options.map_format + "' is neither exr nor pfm");
  config.keep_maps = !options.maps.empty();
  config.projection = options.projection == "perspective" ? Projection::perspective : Projection::orthographic;
  return config;
}

nlohmann::json to_json(const MeshQuality& q) {
  return {{"triangles", q.triangles},
          {"vertices", q.vertices},
          {"slivers", q.slivers},
          {"sliver_share", q.sliver_share()},
          {"worst_aspect", q.worst_aspect},
          {"no_area", q.no_area},
          {"border_edges", q.border_edges},
          {"border_length", q.border_length},
          {"non_manifold_edges", q.non_manifold_edges},
          {"non_manifold_vertices", q.non_manifold_vertices},
          {"inconsistent_edges", q.inconsistent_edges},
          {"manifold", q.manifold()},
          {"closed", q.closed()},
          {"components", q.components},
          {"euler", q.euler}};
}

nlohmann::json to_json(const DirectedDistance& d) {
  return {{"max", d.max}, {"rms", d.rms}, {"mean", d.mean}, {"p99", d.p99}, {"samples", d.samples}};
}

nlohmann::json to_json(const ReconstructReport& r, double scale) {
  using lodestone::to_json;
  return {{"spacing", r.spacing * scale},
          {"pixels", r.pixels},
          {"seen", r.seen},
          {"view_triangles", r.view_triangles},
          {"sampled_triangles", r.sampled_triangles},
          {"input_closed", r.closed},
          {"views", r.views.directions.size() + r.views.inside.size()},
          {"inside_views", r.views.inside.size()},
          {"visible", r.views.visible},
          {"coverable", r.views.coverable},
          {"covered", r.views.covered},
          {"stitch",
           {{"islands", r.stitch.islands},
            {"zipped", r.stitch.zipped},
            {"holes_filled", r.stitch.holes_filled},
            {"hole_triangles", r.stitch.hole_triangles},
            {"longest_filled", r.stitch.longest_filled * scale},
            {"handles", r.stitch.handles},
            {"holes_open", r.stitch.holes_open},
            {"open_length", r.stitch.open_length * scale},
            {"crumbs", r.stitch.crumbs},
            {"vertices_split", r.stitch.vertices_split},
            {"collapsed", r.stitch.collapsed},
            {"flipped", r.stitch.flipped}}},
          {"taken_over", {{"parts", r.lost.parts}, {"triangles", r.lost.triangles}}},
          {"sharpened", {{"edges", r.sharpen.edges}, {"corners", r.sharpen.corners}}},
          {"stages",
           {{"views", to_json(r.choose)},
            {"draw", to_json(r.draw)},
            {"connect", to_json(r.connect)},
            {"merge", to_json(r.merge)},
            {"merge_own", to_json(r.stitch.own)},
            {"merge_zip", to_json(r.stitch.zip)},
            {"sharpen", to_json(r.sharpen_time)},
            {"simplify", to_json(r.simplify)},
            {"attributes", to_json(r.attributes)}}}};
}

// "out.ply" is "out.2.ply" for level 2.
std::string level_name(const std::string& output, int level) {
  if (level == 0) return output;
  const std::filesystem::path path(output);
  return (path.parent_path() / (path.stem().string() + "." + std::to_string(level) + path.extension().string()))
      .string();
}

class ReconstructRun {
 public:
  ReconstructRun(const ReconstructOptions& options, const CommonOptions& common)
      : options_(options), common_(common), config_(config_of(options)), progress_("reconstructing", common.quiet) {}

  void run() {
    check_output();
    const auto scheduler = make_scheduler(common_);
    nlohmann::json levels = nlohmann::json::array(), result = {{"input", options_.input}};
    if (is_map_set(options_.input)) {
      levels.push_back(from_maps(*scheduler));
    } else {
      result.update(read(*scheduler));
      if (options_.distance > 0) config_.resolution = resolution_at_distance(mesh_, options_.distance);
      for (int level = 0; level < options_.levels; ++level) {
        levels.push_back(make_level(level, *scheduler));
        check_interrupt();
      }
    }
    progress_.clear();
    result.update({{"merge", options_.merge},
                   {"backend", config_.backend},
                   {"levels", levels},
                   {"peak_bytes", peak_resident_bytes()}});
    write_json(common_, result);
  }

 private:
  void check_output() const {
    std::vector<FileArgument> outputs;
    for (int level = 0; level < options_.levels; ++level)
      outputs.push_back({"--output", level_name(options_.output, level)});
    check_files(common_, {{"IN", options_.input}}, outputs);
  }

  nlohmann::json read(Scheduler& scheduler) {
    progress_.phase("reading");
    ReadConfig reading = read_config(options_.reading, {options_.input});
    reading.attributes = config_.attributes;
    const CpuClock clock;
    Repairs repairs;
    mesh_ = prepare_mesh(load_mesh(options_.input, scheduler, reading), repairs, scheduler, options_.input);
    check_interrupt();
    return {{"triangles", mesh_.triangles.size()}, {"repairs", to_json(repairs)}, {"read", to_json(clock.elapsed())}};
  }

  nlohmann::json from_maps(Scheduler& scheduler) {
    if (options_.measure || options_.distance > 0 || options_.triangles > 0 || options_.levels > 1 ||
        config_.keep_maps || config_.attributes)
      throw InputError(describe(options_.input, "", "position maps know no surface to measure, sample or draw again",
                                "leave out --measure, --distance, --triangles, --levels, --maps and --attributes"));
    progress_.phase("reading");
    Reconstruction result;
    DrawnMaps drawn = drawn_maps(read_map_set(options_.input), result.report);
    const Transform transform = drawn.maps.front().transform;
    progress_.phase("reconstructing");
    result.mesh = mesh_from_maps(drawn, nullptr, config_, result.report, scheduler);
    config_.resolution = 1 / result.report.spacing;
    return finish(result, transform, options_.output, scheduler);
  }

  nlohmann::json make_level(int level, Scheduler& scheduler) {
    progress_.phase("reconstructing");
    Reconstruction result;
    if (options_.triangles > 0 && level == 0) {
      result = reconstruct_to_triangles(mesh_, config_, options_.triangles, scheduler);
      config_.resolution = 1 / result.report.spacing;
    } else {
      result = reconstruct(mesh_, config_, scheduler);
    }
    nlohmann::json row = finish(result, mesh_.transform, level_name(options_.output, level), scheduler);
    if (config_.keep_maps && level == 0)
      write_map_set(options_.maps, result.maps, {result.report.closed, result.report.oriented},
                    options_.map_format == "exr" ? MapFormat::exr : MapFormat::pfm);
    config_.resolution /= 2;
    return row;
  }

  // Writes the mesh and says what it is like.
  nlohmann::json finish(const Reconstruction& result, const Transform& transform, const std::string& output,
                        Scheduler& scheduler) {
    if (result.mesh.triangles.empty())
      throw InputError(describe(options_.input, "", "no view sees three neighbouring samples of a surface",
                                "give a higher --resolution"));
    const RawMesh split = split_wedges(result.mesh);
    write_mesh(output, view_of(split));
    const MeshQuality quality = measure_quality(result.mesh.positions, result.mesh.triangles);
    nlohmann::json row = to_json(result.report, transform.scale);
    row["file"] = output, row["resolution"] = config_.resolution, row["mesh"] = to_json(quality);
    row["wedges"] = split.positions.size();
    std::string line;
    if (options_.measure) line = measure(result, row, scheduler);
    print(result, quality, output, line);
    return row;
  }

  // Distances both ways, and the share of the visible surface that has the new one within a sample's spacing.
  std::string measure(const Reconstruction& result, nlohmann::json& row, Scheduler& scheduler) {
    progress_.phase("comparing");
    const MeshDistance d = compare_meshes(in_model_space(mesh_), result.mesh, {}, scheduler);
    row["distance"] = {{"diagonal", d.diagonal}, {"from_input", to_json(d.forward)}, {"to_input", to_json(d.backward)}};
    const ReconstructReport& r = result.report;
    const SurfaceCoverage seen =
        measure_coverage(r.views.visible_points, result.mesh, mesh_.transform, r.spacing, scheduler);
    const double scale = mesh_.transform.scale;
    row["coverage"] = seen.share;
    row["distance"]["from_visible_input"] = {{"rms", seen.rms * scale}, {"max", seen.max * scale}};
    const double percent = d.diagonal > 0 ? 100 / d.diagonal : 0;
    return fmt::format(
        ", coverage {:.2f} %, rms {:.4f} (of what is visible {:.4f}) / {:.4f} %, "
        "max {:.3f} / {:.3f} % of the diagonal",
        100 * seen.share, d.forward.rms * percent, seen.rms * scale * percent, d.backward.rms * percent,
        d.forward.max * percent, d.backward.max * percent);
  }

  void print(const Reconstruction& result, const MeshQuality& quality, const std::string& output,
             const std::string& line) {
    if (common_.quiet || common_.json == "-") return;
    progress_.clear();
    fmt::print("{}: {} triangles at {:.0f} pixels; {}{}, slivers {:.2f} %, {} holes filled{}\n", output,
               quality.triangles, config_.resolution, quality.manifold() ? "manifold" : "not manifold",
               quality.closed() ? ", closed" : fmt::format(", {} border edges", quality.border_edges),
               100 * quality.sliver_share(), result.report.stitch.holes_filled, line);
  }

  const ReconstructOptions& options_;
  const CommonOptions& common_;
  ReconstructConfig config_;
  Progress progress_;
  IndexedMesh mesh_;
};

}  // namespace

void add_reconstruct(CLI::App& app) {
  const auto common = std::make_shared<CommonOptions>();
  const auto options = std::make_shared<ReconstructOptions>();
  ReconstructConfig& config = options->config;
  CLI::App& command = add_command(
      app, "reconstruct", "Make LOD meshes from rendered position maps",
      "  lodestone reconstruct scan.ply -o lod.ply --resolution 256 --measure\n"
      "  lodestone reconstruct scan.ply -o lod.ply --triangles 20000 --json report.json\n"
      "  lodestone reconstruct scan.ply -o lod.ply --merge concatenate --views faces\n"
      "  lodestone reconstruct scan.ply -o lod.ply --maps maps && lodestone reconstruct maps -o again.ply\n",
      common);
  command
      .add_option("IN", options->input,
                  std::string("Mesh: ") + mesh_formats + "; or position maps: a views.json or its folder")
      ->required();
  command.add_option("-o,--output", options->output, "Mesh to write: .ply, .obj, .stl or .glb")->required();
  command
      .add_option("--views", options->views,
                  "faces: the six of the bounding box; auto: and more by uncovered area; or how many")
      ->capture_default_str();
  CLI::Option* resolution =
      command.add_option("--resolution", config.resolution, "Pixels along the longest side of the bounding box")
          ->capture_default_str();
  CLI::Option* distance =
      command
          .add_option("--distance", options->distance,
                      "Instead: one sample a pixel as seen from so far (model units, 45 degrees, 1080 rows)")
          ->check(CLI::PositiveNumber);
  CLI::Option* triangles = command.add_option("--triangles", options->triangles, "Instead: about so many triangles")
                               ->check(CLI::PositiveNumber);
  resolution->excludes(distance)->excludes(triangles);
  distance->excludes(triangles);
  command
      .add_option("--detail", config.detail,
                  "Draw maps so many times finer, and simplify to the triangles of the resolution; 1: do not")
      ->capture_default_str();
  command.add_option("--merge", options->merge, "stitch: one surface; concatenate: the views' meshes side by side")
      ->capture_default_str();
  command.add_option("--backend", config.backend, "soft or gl")->capture_default_str();
  command.add_option("--projection", options->projection, "orthographic or perspective (from four radii away)")
      ->capture_default_str();
  command
      .add_option("--levels", options->levels,
                  "So many meshes, each at half the resolution of the one before; OUT.1.ply and so on")
      ->check(CLI::Range(1, 12))
      ->capture_default_str();
  command.add_option("--max-slope", config.max_slope, "Depth over width between connected pixels")
      ->capture_default_str();
  command.add_option("--slack", config.slack, "A jump of so many pixel spacings is bridged anyway")
      ->capture_default_str();
  command
      .add_option("--sharp", config.sharp_degrees, "Angle in degrees from which sharp features are recovered; 0: none")
      ->capture_default_str();
  command
      .add_option("--fill", config.longest_hole,
                  "Fill holes up to this perimeter, in pixel spacings; of a closed surface all; 0: none")
      ->capture_default_str();
  command.add_flag("!--no-condense", config.condense, "Draw the maps at the resolution itself, not at twice that");
  command.add_flag("--extend", config.extend,
                   "Extend borders to the silhouette: for single views, and parts of a pixel's width");
  command.add_flag("!--no-parts", config.separate_parts, "Connect parts of the mesh that share no vertex, too");
  command.add_flag("!--no-small-parts", config.lost_parts, "Leave out parts of the mesh that no three pixels see");
  command.add_flag("--attributes", config.attributes,
                   "Resample texture coordinates, colours and normals, too; .glb keeps all of them");
  CLI::Option* maps =
      command.add_option("--maps", options->maps, "Folder to write the position maps to, with a views.json");
  command.add_option("--map-format", options->map_format, "exr (all channels) or pfm (positions)")
      ->capture_default_str()
      ->needs(maps);
  command.add_flag("--measure", options->measure, "Measure the distance from the input, both ways");
  add_input_options(command, options->reading);
  command.callback([options, common] { ReconstructRun(*options, *common).run(); });
}

}  // namespace lodestone
