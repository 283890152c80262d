// lodestone reconstruct: LOD meshes from rendered position maps.
#include "experiments/subjects/reconstruct.h"

#include <fmt/core.h>

#include "core/base/error.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/subjects/compare.h"

namespace lodestone {
namespace {

struct ReconstructOptions {
  std::string input, output, maps;
  InputOptions reading;
  std::string views = "auto", merge = "stitch", projection = "orthographic", map_format = "exr";
  ReconstructConfig config;
  std::optional<double> resolution, distance;
  std::optional<std::uint64_t> triangles;
  int levels = 1;
  bool outside_only = false, measure = false;
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
    throw UsageError("--views: '" + text + "' is not faces, auto or a number from 1 to 999");
  choice.most = choice.least = std::stoi(text);
  return choice;
}

ReconstructJob job_of(const ReconstructOptions& options) {
  ReconstructJob job;
  job.input = options.input;
  job.output = options.output;
  job.reading = read_config(options.reading, {options.input});
  job.config = options.config;
  job.config.resolution = options.resolution.value_or(job.config.resolution);
  job.map_resolution = options.resolution.value_or(0);
  job.config.views = view_choice(options.views);
  job.config.merge = options.outside_only ? MergeKind::shell : merge_kind(options.merge);
  job.config.projection = projection_kind(options.projection);
  if (options.map_format != "exr" && options.map_format != "pfm")
    throw UsageError("--map-format: '" + options.map_format + "' is neither exr nor pfm");
  job.map_format = options.map_format == "exr" ? MapFormat::exr : MapFormat::pfm;
  job.distance = options.distance.value_or(0);
  job.triangles = options.triangles.value_or(0);
  job.levels = options.levels;
  job.maps = options.maps;
  job.measure = options.measure;
  return job;
}

Json stitch_json(const StitchReport& stitch, double scale) {
  return {{"islands", stitch.islands},
          {"zipped", stitch.zipped},
          {"hole_triangles", stitch.hole_triangles},
          {"longest_filled", stitch.longest_filled * scale},
          {"handles", stitch.handles},
          {"holes_open", stitch.holes_open},
          {"open_length", stitch.open_length * scale},
          {"crumbs", stitch.crumbs},
          {"vertices_split", stitch.vertices_split},
          {"collapsed", stitch.collapsed},
          {"flipped", stitch.flipped}};
}

Json stages_of(const ReconstructReport& r) {
  using lodestone::to_json;
  return {{"views", to_json(r.choose)},         {"draw", to_json(r.draw)},
          {"connect", to_json(r.connect)},      {"merge", to_json(r.merge)},
          {"merge_own", to_json(r.stitch.own)}, {"merge_zip", to_json(r.stitch.zip)},
          {"sharpen", to_json(r.sharpen_time)}, {"simplify", to_json(r.simplify)},
          {"attributes", to_json(r.attributes)}};
}

// The row of a level, and what a person or a script may want to know besides.
Json to_json(const ReconstructResult& result) {
  using lodestone::to_json;
  const ReconstructReport& r = result.report;
  const MeshQuality& q = result.quality;
  Json json = without_nulls(to_row(result));
  json.update(
      {{"file", result.file},
       {"resolution", result.resolution},
       {"wedges", result.wedges},
       {"spacing", r.spacing * result.scale},
       {"seen", r.seen},
       {"sampled_triangles", r.sampled_triangles},
       {"views", {{"visible", r.views.visible}, {"coverable", r.views.coverable}, {"covered", r.views.covered}}},
       {"mesh",
        {{"worst_aspect", q.worst_aspect},
         {"no_area", q.no_area},
         {"border_length", q.border_length},
         {"non_manifold_edges", q.non_manifold_edges},
         {"non_manifold_vertices", q.non_manifold_vertices},
         {"inconsistent_edges", q.inconsistent_edges},
         {"components", q.components}}},
       {"stitch", stitch_json(r.stitch, result.scale)},
       {"warnings", result.warnings},
       {"shell",
        {{"grid_points", r.shell.grid_points},
         {"sheet_points", r.shell.sheet_points},
         {"cavities", r.shell.cavities},
         {"crumbs", r.shell.crumbs}}},
       {"taken_over", {{"parts", r.lost.parts}, {"triangles", r.lost.triangles}}},
       {"sharpened", {{"edges", r.sharpen.edges}, {"corners", r.sharpen.corners}}},
       {"stages", stages_of(r)}});
  if (result.error)
    json.update(
        {{"diagonal", result.error->distance.diagonal},
         {"forward", to_json(result.error->distance.forward)},
         {"backward", to_json(result.error->distance.backward)},
         {"visible", {{"rms", result.coverage->rms * result.scale}, {"max", result.coverage->max * result.scale}}},
         {"seen_pixels", {{"rms", result.seen->rms * result.scale}, {"max", result.seen->max * result.scale}}}});
  return json;
}

std::string accuracy_text(const ReconstructResult& result) {
  if (!result.error) return "";
  const MeshDistance& d = result.error->distance;
  const double percent = d.diagonal > 0 ? 100 / d.diagonal : 0;
  const double seen_percent = result.scale * percent;
  return fmt::format(
      ", coverage {:.2f} % of pixels seen from all around ({:.2f} % of all that any direction sees), rms {:.4f} (seen "
      "pixels {:.4f}, visible part {:.4f}) / {:.4f} %, max {:.3f} / {:.3f} % of the diagonal",
      100 * result.seen->share, 100 * result.coverage->share, d.forward.rms * percent, result.seen->rms * seen_percent,
      result.coverage->rms * seen_percent, d.backward.rms * percent, d.forward.max * percent, d.backward.max * percent);
}

void print(const ReconstructResult& result) {
  const MeshQuality& quality = result.quality;
  fmt::print("{}: {} triangles at {:.0f} pixels; {}{}, slivers {:.2f} %, {} holes filled{}\n", result.file,
             result.triangles, result.resolution, quality.manifold() ? "manifold" : "not manifold",
             quality.closed() ? ", closed" : fmt::format(", {} border edges", quality.border_edges),
             100 * quality.sliver_share(), result.report.stitch.holes_filled, accuracy_text(result));
  print_warnings(result.warnings);
}

void run(const ReconstructOptions& options, const CommonOptions& common) {
  ReconstructJob job = job_of(options);
  std::vector<FileArgument> outputs;
  for (int level = 0; level < options.levels; ++level)
    outputs.push_back({"--output", level_file(options.output, level)});
  check_files(common, {{"IN", options.input}}, outputs);
  Progress progress("reconstructing", common.quiet);
  job.on_phase = [&](const std::string& phase) { progress.phase(phase); };
  job.on_level = [&](const ReconstructResult& result) {
    progress.clear();
    if (common.prints()) print(result);
  };
  const ReconstructResults results = run(job, *make_scheduler(common));
  progress.clear();
  if (common.prints()) print_up_note(results.up);
  Json levels = Json::array();
  for (const ReconstructResult& result : results.levels) levels.push_back(to_json(result));
  Json json{{"input", options.input},
            {"merge", options.merge},
            {"backend", options.config.backend},
            {"levels", levels},
            {"peak_bytes", peak_resident_bytes()}};
  if (results.input_triangles > 0)
    json.update({{"input_triangles", results.input_triangles},
                 {"repairs", to_json(results.repairs)},
                 {"read_seconds", results.read.seconds}});
  write_result(common, json);
}

// Options of the meshes and views.
OptionTable declare_meshes(ReconstructOptions& o) {
  return {
      OptionSpec{"IN", &o.input,
                 std::string("Mesh: ") + mesh_formats + "; or position maps: a views.json or its folder"}
          .must(),
      OptionSpec{"-o,--output", &o.output, "Mesh to write: .ply, .obj, .stl or .glb"}.must(),
      {"--views", &o.views, "faces: the six of the bounding box; auto: and more by uncovered area; or their number"},
      {"--resolution", &o.resolution, "Pixels along the longest side of the bounding box; 256, or those of the maps"},
      OptionSpec{"--distance", &o.distance,
                 "Instead: one sample per pixel as seen from this distance (model units, 45 degrees, 1080 rows)"}
          .at_least(1e-300)
          .not_with({"--resolution"}),
      OptionSpec{"--triangles", &o.triangles, "Instead: approximate number of triangles"}.at_least(1).not_with(
          {"--resolution", "--distance"}),
      {"--detail", &o.config.detail,
       "Factor by which maps are drawn finer; the mesh is simplified to the triangles of the resolution; 1: do "
       "not"},
      {"--merge", &o.merge, "stitch: one surface; concatenate: the views' meshes side by side"},
      {"--backend", &o.config.backend, "soft or gl"},
      {"--projection", &o.projection, "orthographic or perspective (from four radii away)"},
      OptionSpec{"--outside-only", &o.outside_only,
                 "Only what can be seen from outside, as one closed shell; parts may overlap in any way"}
          .not_with({"--merge", "--projection"}),
      OptionSpec{"--levels", &o.levels,
                 "Number of meshes, each at half the resolution of the one before; OUT.1.ply and so on"}
          .between(1, 12)};
}

// Options of the surface that is made of the maps.
OptionTable declare_surface(ReconstructOptions& o) {
  ReconstructConfig& config = o.config;
  return {
      {"--max-slope", &config.max_slope, "Depth over width between connected pixels"},
      {"--slack", &config.slack, "A jump of up to this number of pixel spacings is bridged anyway"},
      {"--sharp", &config.sharp_degrees, "Angle in degrees from which sharp features are recovered; 0: none"},
      {"--fill", &config.longest_hole,
       "Fill holes up to this perimeter, in pixel spacings; of a closed surface all; 0: none"},
      {"!--no-condense", &config.condense, "Draw the maps at the resolution itself, not at twice that"},
      {"--extend", &config.extend, "Extend borders to the silhouette: for single views, and parts of a pixel's width"},
      {"!--no-parts", &config.separate_parts, "Connect parts of the mesh that share no vertex, too"},
      {"!--no-small-parts", &config.lost_parts, "Leave out parts of the mesh that no three pixels see"},
      {"--attributes", &config.attributes,
       "Resample texture coordinates, colours and normals, too; .glb keeps all of them"},
      up_option(o.reading.up),
      {"--maps", &o.maps, "Folder to write the position maps to, with a views.json"},
      OptionSpec{"--map-format", &o.map_format, "exr (all channels) or pfm (positions)"}.only_with({"--maps"}),
      {"--measure", &o.measure, "Measure the distance from the input, both ways"}};
}

OptionTable declare(ReconstructOptions& o) {
  OptionTable table = declare_meshes(o);
  for (OptionSpec& option : declare_surface(o)) table.push_back(std::move(option));
  return with_input_options(std::move(table), o.reading);
}

}  // namespace

void add_reconstruct(CommandTable& commands) {
  define_command<ReconstructOptions>(
      commands,
      {"reconstruct", "Make LOD meshes from rendered position maps",
       "  lodestone reconstruct scan.ply -o lod.ply --resolution 256 --measure\n"
       "  lodestone reconstruct scan.ply -o lod.ply --triangles 20000 --json report.json\n"
       "  lodestone reconstruct scan.ply -o lod.ply --merge concatenate --views faces\n"
       "  lodestone reconstruct scan.ply -o lod.ply --maps maps && lodestone reconstruct maps -o again.ply\n"},
      declare, run);
}

}  // namespace lodestone
