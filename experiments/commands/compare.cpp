// lodestone compare: how far two surfaces are from each other, both ways.
#include "parallel/compare.h"

#include <fmt/core.h>

#include "core/base/error.h"
#include "core/hierarchy/level_mesh.h"
#include "core/hierarchy/lode_file.h"
#include "core/io/mesh_file.h"
#include "experiments/commands/command.h"
#include "parallel/load.h"

namespace lodestone {
namespace {

struct CompareOptions {
  std::string a, b;
  CompareConfig config;
};

// "scan.ply", or "scan.lode", or "scan.lode:3" for a level of a hierarchy.
RawMesh surface(const std::string& name, Scheduler& scheduler) {
  const std::size_t at = name.rfind(".lode");
  if (at == std::string::npos || (at + 5 != name.size() && name[at + 5] != ':')) return load_mesh(name, scheduler);
  const Hierarchy hierarchy = open_lode(name.substr(0, at + 5));
  int level = hierarchy.finest();
  if (at + 5 != name.size()) {
    const std::string number = name.substr(at + 6);
    if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos || number.size() > 2 ||
        std::stoi(number) > hierarchy.finest())
      throw InputError(describe(name, "", "there is no level '" + number + "'",
                                fmt::format("the levels are 0 to {}", hierarchy.finest())));
    level = std::stoi(number);
  }
  return level_mesh(hierarchy, level);
}

nlohmann::json to_json(const DirectedDistance& d) {
  return {{"max", d.max}, {"rms", d.rms}, {"mean", d.mean}, {"p99", d.p99}, {"samples", d.samples}};
}

void run(const CompareOptions& options, const CommonOptions& common) {
  const auto scheduler = make_scheduler(common);
  const RawMesh a = surface(options.a, *scheduler);
  const RawMesh b = surface(options.b, *scheduler);
  const MeshDistance result = compare_meshes(a, b, options.config, *scheduler);
  write_json(common, {{"a", options.a},
                      {"b", options.b},
                      {"diagonal", result.diagonal},
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
}

}  // namespace

void add_compare(CLI::App& app) {
  const auto common = std::make_shared<CommonOptions>();
  const auto options = std::make_shared<CompareOptions>();
  CLI::App& command = add_command(app, "compare", "Distances between two surfaces, in both directions",
                                  "  lodestone compare scan.ply scan.lode:3\n"
                                  "  lodestone compare a.obj b.obj --json distance.json\n",
                                  common);
  command.add_option("A", options->a, "Mesh, .lode file, or FILE.lode:LEVEL")->required();
  command.add_option("B", options->b, "The other one")->required();
  command.callback([options, common] { run(*options, *common); });
}

}  // namespace lodestone
