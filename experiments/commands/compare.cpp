// lodestone compare: how far two surfaces are from each other, both ways.
#include "experiments/subjects/compare.h"

#include <fmt/core.h>

#include "core/formats/mesh_file.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"

namespace lodestone {
namespace {

struct CompareOptions {
  std::string a, b;
  InputOptions reading;
};

void print(const CompareResult& result) {
  const double diagonal = result.distance.diagonal, percent = diagonal > 0 ? 100 / diagonal : 0;
  fmt::print("diagonal {:g}; distances in model units (and in % of the diagonal)\n", diagonal);
  const auto line = [&](const char* name, const DirectedDistance& d) {
    fmt::print("{:<8} max {:g} ({:.4f} %)  rms {:g} ({:.4f} %)  mean {:g}  p99 {:g}\n", name, d.max, d.max * percent,
               d.rms, d.rms * percent, d.mean, d.p99);
  };
  line("A to B", result.distance.forward);
  line("B to A", result.distance.backward);
  print_warnings(result.warnings);
  if (const auto count = result.non_finite_triangles[0] + result.non_finite_triangles[1]; count > 0)
    fmt::print("left out: {} triangles with a corner that is not finite\n", count);
}

void run(const CompareOptions& options, const CommonOptions& common) {
  Progress progress("reading", common.quiet);
  CompareJob job{SurfaceName(options.a), SurfaceName(options.b)};
  check_files(common, {{"A", job.a.file}, {"B", job.b.file}});
  job.reading = read_config(options.reading, {job.a.file, job.b.file});
  job.reading.attributes = false;
  job.on_phase = [&](const std::string& phase) { progress.phase(phase); };
  const CompareResult result = run(job, *make_scheduler(common));
  progress.clear();
  Json json = to_row(result.distance);
  json.update({{"a", options.a},
               {"b", options.b},
               {"diagonal", result.distance.diagonal},
               {"non_finite_triangles", result.non_finite_triangles},
               {"forward", to_json(result.distance.forward)},
               {"backward", to_json(result.distance.backward)}});
  write_result(common, json);
  if (common.prints()) print(result);
}

OptionTable declare(CompareOptions& o) {
  return with_input_options(
      {OptionSpec{"A", &o.a, std::string("A .lode file, FILE.lode:LEVEL, or a mesh: ") + mesh_formats}.must(),
       OptionSpec{"B", &o.b, "The other one"}.must()},
      o.reading);
}

}  // namespace

void add_compare(CommandTable& commands) {
  define_command<CompareOptions>(commands,
                                 {"compare", "Distances between two surfaces, in both directions",
                                  "  lodestone compare scan.ply scan.lode:3\n"
                                  "  lodestone compare a.obj b.obj --json distance.json\n"},
                                 declare, run);
}

}  // namespace lodestone
