// lodestone spherical: a scan as one mesh over the sphere, with seamless textures and levels that change freely.
#include "experiments/subjects/spherical.h"

#include <fmt/core.h>

#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"

namespace lodestone {
namespace {

struct SphericalOptions {
  std::string input, output, effort = "normal", cut = "auto", maps = to_string(SphericalMaps{}), images = "webp";
  InputOptions reading;
  std::uint32_t texture = SphericalConfig{}.texture;
  std::uint64_t components = 0, triangles = 0;
  int quality = SphericalConfig{}.quality;
  bool compress = false;
};

SphericalJob job_of(const SphericalOptions& options) {
  SphericalJob job;
  job.input = options.input;
  job.output = options.output;
  job.reading = read_config(options.reading, {options.input});
  job.config.map.effort = sphere_effort(options.effort);
  job.config.choose_cut = options.cut == "auto";
  job.config.texture = options.texture;
  job.config.media_type = "image/" + options.images;
  job.config.quality = options.quality;
  job.config.maps = spherical_maps(options.maps);
  job.config.components = options.components;
  job.config.progressive.finest_triangles = options.triangles;
  job.compress = options.compress;
  return job;
}

Json to_json(const SphericalResult& result, const Row& row, const SphericalOptions& options) {
  using lodestone::to_json;
  const spherical::ManifoldRepairs& manifold = result.report.topology.manifold;
  Json json = without_nulls(row);
  json.update({{"input", options.input},
               {"output", options.output},
               {"effort", options.effort},
               {"guard", SphereMapConfig{}.guard},
               {"texture", options.texture},
               {"greatest_genus", result.report.topology.greatest_genus},
               {"loop_lengths",
                {{"min", result.report.topology.loops.least},
                 {"mean", result.report.topology.loops.mean},
                 {"max", result.report.topology.loops.greatest}}},
               {"manifold",
                {{"turned_triangles", manifold.turned_triangles},
                 {"nonmanifold_edges", manifold.nonmanifold_edges},
                 {"clashing_edges", manifold.clashing_edges},
                 {"pinched_vertices", manifold.pinched_vertices},
                 {"vertex_copies", manifold.vertex_copies},
                 {"split_edges", manifold.split_edges}}},
               {"repairs", to_json(result.repairs)},
               {"warnings", result.warnings}});
  return json;
}

void print(const SphericalResult& result, const Row& row, const SphericalOptions& options) {
  const auto number = [&](const char* column) { return row.at(column).get<double>(); };
  fmt::print("{}: {} triangles in {:.2f} s, {:.0f} kB: {:.0f} colours, {:.0f} normals, {:.0f} geometry\n",
             options.output, number("input_triangles"), number("seconds"), number("file_bytes") / 1000,
             number("colour_bytes") / 1000, number("normal_bytes") / 1000, number("geometry_bytes") / 1000);
  if (number("material_bytes") > 0)
    fmt::print("other images of materials: {:.0f} kB\n", number("material_bytes") / 1000);
  fmt::print("closed for the mapping: {} holes and {} handles of {} components\n", number("holes"), number("handles"),
             number("components"));
  if (result.report.left_out > 0) fmt::print("left out: {} smaller components\n", result.report.left_out);
  fmt::print("map: efficiency {:.3f}, {} of its triangles turned over, {} slivers (the input has {})\n",
             number("efficiency"), number("flips"), number("slivers"), number("surface_slivers"));
  if (!row.at("colour_psnr").is_null()) fmt::print("colours: {:.1f} dB\n", number("colour_psnr"));
  if (!row.at("geometry_image_rms").is_null())
    fmt::print("geometry image: {} samples, {:.0f} kB, RMS {:.4f} % of the diagonal, at most {:.3f} %\n",
               number("geometry_image_samples"), number("geometry_image_bytes") / 1000, number("geometry_image_rms"),
               number("geometry_image_max"));
  if (!row.at("normal_psnr").is_null()) fmt::print("normals: {:.1f} dB\n", number("normal_psnr"));
  if (!row.at("tangent_angle").is_null())
    fmt::print("normals in other viewers: {:.1f} degrees off, by a map of {:.0f} kB\n", number("tangent_angle"),
               number("tangent_bytes") / 1000);
  print_up_note(result.mesh.transform.up);
  print_repairs(result.repairs);
  print_warnings(result.warnings);
}

void run(const SphericalOptions& options, const CommonOptions& common) {
  SphericalJob job = job_of(options);
  const bool lpm = options.output.ends_with(".lpm");
  check_files(common, {{"IN", options.input}}, {{"--output", options.output, lpm ? ".lpm" : ".glb"}});
  Progress progress("reading", common.quiet);
  job.config.on_phase = [&](const std::string& phase) { progress.phase(phase); };
  const SphericalResult result = run(job, *make_scheduler(common));
  progress.clear();
  const Row row = to_row(result);
  write_result(common, to_json(result, row, options));
  if (common.prints()) print(result, row, options);
}

OptionTable declare(SphericalOptions& o) {
  return with_input_options(
      {OptionSpec{"IN", &o.input, std::string("Mesh: ") + mesh_formats}.must(),
       OptionSpec{"-o,--output", &o.output, ".glb (every viewer shows it) or .lpm (small); `lodestone page` draws both"}
           .must(),
       OptionSpec{"--effort", &o.effort, "How long the map to the sphere is improved"}.one_of(
           {"fast", "normal", "best"}),
       OptionSpec{"--cut", &o.cut, "Cut the sphere open where it shows least, or as the map left it"}.one_of(
           {"auto", "none"}),
       {"--components", &o.components, "Components to keep, the largest; 0: all"},
       {"--triangles", &o.triangles, "Triangles of the finest level, at most; 0: all; images are made from all"},
       OptionSpec{"--texture", &o.texture, "Pixels along a side of the images, a power of two; small parts get fewer"}
           .between(16, 16384),
       OptionSpec{"--maps", &o.maps, "The images, of colour (and what else materials have), normal, geometry"}.of_type(
           "NAMES"),
       OptionSpec{"--images", &o.images, "Format of the images"}.one_of({"webp", "jpeg", "png"}),
       OptionSpec{"--quality", &o.quality,
                  "Of webp and jpeg, of normals in webp 65 % of it; webp of 100 is without loss"}
           .between(1, 100),
       up_option(o.reading.up),
       {"--compress", &o.compress, ".glb: by EXT_meshopt_compression, without loss"}},
      o.reading);
}

}  // namespace

void add_spherical(CommandTable& commands) {
  define_command<SphericalOptions>(
      commands,
      {"spherical", "Map a scan to the sphere: seamless textures, levels that change freely",
       "  lodestone spherical statue.obj -o statue.glb\n"
       "  lodestone spherical scan.ply -o scan.lpm --effort best --texture 2048 --quality 80\n"},
      declare, run);
}

}  // namespace lodestone
