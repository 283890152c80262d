// lodestone generate: test surfaces of any size.
#include "parallel/mesh/generate.h"

#include <fmt/core.h>

#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/metrics/cost/cost.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

struct GenerateOptions {
  std::string shape_name, output;
  std::uint64_t triangles = GenerateConfig{}.triangles, seed = GenerateConfig{}.seed;
};

void run(const GenerateOptions& options, const CommonOptions& common) {
  const GenerateConfig config{shape(options.shape_name), options.triangles, options.seed};
  check_files(common, {}, {{"--output", options.output, ".ply"}});
  const auto scheduler = make_scheduler(common);
  const CpuClock clock;
  Progress progress("generating", common.quiet);
  progress.measure(static_cast<double>(config.triangles), "triangles");
  const GenerateResult result = generate_ply(config, options.output, *scheduler, &interrupt_flag(),
                                             [&](double share) { progress.update(share); });
  progress.clear();
  const StageTime time = clock.elapsed();
  write_result(common, {{"output", options.output},
                        {"shape", options.shape_name},
                        {"seed", config.seed},
                        {"triangles", result.triangles},
                        {"vertices", result.vertices},
                        {"bytes", result.bytes},
                        {"seconds", time.seconds},
                        {"cpu_seconds", time.cpu_seconds},
                        {"peak_bytes", peak_resident_bytes()}});
  if (common.prints()) fmt::print("{}: {} triangles, {} vertices\n", options.output, result.triangles, result.vertices);
}

OptionTable declare(GenerateOptions& o) {
  return {OptionSpec{"SHAPE", &o.shape_name, "sphere, terrain, torus, box or pile (of overlapping boxes)"}.must(),
          {"--triangles", &o.triangles, "Number of triangles; the nearest regular grid is taken"},
          {"--seed", &o.seed, "Seed of the displacement"},
          OptionSpec{"-o,--output", &o.output, "File to write (.ply)"}.must()};
}

}  // namespace

void add_generate(CLI::App& app) {
  define_command(app,
                 {"generate", "Write a generated surface as binary PLY",
                  "  lodestone generate sphere --triangles 1000000 --seed 1 -o sphere.ply\n"
                  "  lodestone generate terrain --triangles 64000000 -o terrain.ply\n"},
                 declare, run);
}

}  // namespace lodestone
