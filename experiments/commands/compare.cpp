// lodestone compare: how far two surfaces are from each other, both ways.
#include "parallel/mesh/compare.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/hierarchy/model/level_mesh.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "parallel/build/save.h"
#include "parallel/mesh/load.h"

namespace lodestone {
namespace {

struct CompareOptions {
  std::string a, b;
  InputOptions reading;
  CompareConfig config;
};

// "scan.ply", or "scan.lode", or "scan.lode:3" for a level of a hierarchy.
struct SurfaceName {
  std::string file;
  bool hierarchy = false;
  std::optional<std::string> level;
};

SurfaceName parse_name(const std::string& name) {
  const std::size_t at = name.rfind(".lode");
  if (at == std::string::npos || (at + 5 != name.size() && name[at + 5] != ':')) return {name, false, {}};
  SurfaceName result{name.substr(0, at + 5), true, {}};
  if (at + 5 != name.size()) result.level = name.substr(at + 6);
  return result;
}

int level_number(const SurfaceName& name, const Hierarchy& hierarchy) {
  if (!name.level) return hierarchy.finest();
  const std::string& number = *name.level;
  if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos || number.size() > 2 ||
      std::stoi(number) > hierarchy.finest())
    throw InputError(describe(name.file, "", "there is no level '" + number + "'",
                              fmt::format("the levels are 0 to {}", hierarchy.finest())));
  return std::stoi(number);
}

struct Surface {
  RawMesh mesh;
  std::uint64_t non_finite_triangles = 0;  // left out, as `build` does
};

Surface read_surface(const SurfaceName& name, const ReadConfig& reading, Scheduler& scheduler) {
  if (name.hierarchy) {
    const Hierarchy hierarchy = load_lode(name.file, scheduler);
    return {level_mesh(hierarchy, level_number(name, hierarchy)), 0};
  }
  Surface surface{load_mesh(name.file, scheduler, reading), 0};
  surface.non_finite_triangles = std::erase_if(surface.mesh.triangles, [&](const Triangle& t) {
    return !std::all_of(t.v.begin(), t.v.end(), [&](auto v) { return is_finite(surface.mesh.positions[v]); });
  });
  if (surface.mesh.triangles.empty())
    throw InputError(describe(name.file, "", "every triangle has a corner that is not finite"));
  return surface;
}

nlohmann::json to_json(const DirectedDistance& d) {
  return {{"max", d.max}, {"rms", d.rms}, {"mean", d.mean}, {"p99", d.p99}, {"samples", d.samples}};
}

void run(const CompareOptions& options, const CommonOptions& common) {
  const SurfaceName name_a = parse_name(options.a), name_b = parse_name(options.b);
  check_files(common, {{"A", name_a.file}, {"B", name_b.file}});
  ReadConfig reading = read_config(options.reading, {name_a.file, name_b.file});
  reading.attributes = false;
  const auto scheduler = make_scheduler(common);
  Progress progress("reading", common.quiet);
  progress.phase("reading");
  const Surface a = read_surface(name_a, reading, *scheduler);
  const Surface b = read_surface(name_b, reading, *scheduler);
  progress.phase("comparing");
  const MeshDistance result = compare_meshes(a.mesh, b.mesh, options.config, *scheduler);
  progress.clear();
  write_json(common, {{"a", options.a},
                      {"b", options.b},
                      {"diagonal", result.diagonal},
                      {"non_finite_triangles", {a.non_finite_triangles, b.non_finite_triangles}},
                      {"forward", to_json(result.forward)},
                      {"backward", to_json(result.backward)}});
  if (common.quiet || common.json == "-") return;
  fmt::print("diagonal {:g}; distances in model units (and in % of the diagonal)\n", result.diagonal);
  const auto line = [&](const char* name, const DirectedDistance& d) {
    const double percent = result.diagonal > 0 ? 100 / result.diagonal : 0;
    fmt::print("{:<8} max {:g} ({:.4f} %)  rms {:g} ({:.4f} %)  mean {:g}  p99 {:g}\n", name, d.max, d.max * percent,
               d.rms, d.rms * percent, d.mean, d.p99);
  };
  line("A to B", result.forward);
  line("B to A", result.backward);
  for (const Surface* surface : {&a, &b}) print_warnings(surface->mesh.warnings);
  if (const auto count = a.non_finite_triangles + b.non_finite_triangles; count > 0)
    fmt::print("left out: {} triangles with a corner that is not finite\n", count);
}

}  // namespace

void add_compare(CLI::App& app) {
  const auto common = std::make_shared<CommonOptions>();
  const auto options = std::make_shared<CompareOptions>();
  CLI::App& command = add_command(app, "compare", "Distances between two surfaces, in both directions",
                                  "  lodestone compare scan.ply scan.lode:3\n"
                                  "  lodestone compare a.obj b.obj --json distance.json\n",
                                  common);
  command.add_option("A", options->a, std::string("A .lode file, FILE.lode:LEVEL, or a mesh: ") + mesh_formats)
      ->required();
  command.add_option("B", options->b, "The other one")->required();
  add_input_options(command, options->reading);
  command.callback([options, common] { run(*options, *common); });
}

}  // namespace lodestone
