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
  GenerateConfig config;
};

void run(const GenerateOptions& options, const CommonOptions& common) {
  GenerateConfig config = options.config;
  config.shape = shape(options.shape_name);
  check_files(common, {}, {{"--output", options.output, ".ply"}});
  const auto scheduler = make_scheduler(common);
  const CpuClock clock;
  Progress progress("generating", common.quiet);
  progress.measure(static_cast<double>(config.triangles), "triangles");
  const GenerateResult result = generate_ply(config, options.output, *scheduler, &interrupt_flag(),
                                             [&](double share) { progress.update(share); });
  progress.clear();
  const StageTime time = clock.elapsed();
  write_json(common, {{"output", options.output},
                      {"shape", options.shape_name},
                      {"seed", config.seed},
                      {"triangles", result.triangles},
                      {"vertices", result.vertices},
                      {"bytes", result.bytes},
                      {"seconds", time.seconds},
                      {"cpu_seconds", time.cpu_seconds},
                      {"peak_bytes", peak_resident_bytes()}});
  if (!common.quiet && common.json != "-")
    fmt::print("{}: {} triangles, {} vertices\n", options.output, result.triangles, result.vertices);
}

}  // namespace

void add_generate(CLI::App& app) {
  const auto common = std::make_shared<CommonOptions>();
  const auto options = std::make_shared<GenerateOptions>();
  CLI::App& command = add_command(app, "generate", "Write a generated surface as binary PLY",
                                  "  lodestone generate sphere --triangles 1000000 --seed 1 -o sphere.ply\n"
                                  "  lodestone generate terrain --triangles 64000000 -o terrain.ply\n",
                                  common);
  command.add_option("SHAPE", options->shape_name, "sphere, terrain, torus or box")->required();
  command
      .add_option("--triangles", options->config.triangles, "Number of triangles; the nearest regular grid is taken")
      ->capture_default_str();
  command.add_option("--seed", options->config.seed, "Seed of the displacement")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_option("-o,--output", options->output, "File to write (.ply)")->required();
  command.callback([options, common] { run(*options, *common); });
}

}  // namespace lodestone
