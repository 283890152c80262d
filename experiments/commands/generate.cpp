// lodestone generate: test surfaces of any size, and hard ones.
#include "parallel/mesh/generate.h"

#include <fmt/core.h>

#include <optional>
#include <span>

#include "core/files/atomic_file.h"
#include "core/mesh/hard/hard_cases.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/metrics/cost/cost.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

struct GenerateOptions {
  std::string shape_name, output;
  std::optional<std::uint64_t> triangles;
  std::uint64_t seed = GenerateConfig{}.seed;
};

constexpr std::string_view hard_prefix = "hard:";

void generate_hard(const GenerateOptions& options, const CommonOptions& common) {
  const HardCase& hard = hard_case(std::string_view(options.shape_name).substr(hard_prefix.size()));
  const PolygonMesh mesh = hard.make(options.triangles.value_or(hard.size));
  AtomicFile file(options.output);
  const std::string bytes = hard_ply(mesh);
  file.write(std::as_bytes(std::span(bytes)));
  file.commit();
  write_result(common, {{"output", options.output},
                        {"shape", options.shape_name},
                        {"what", hard.what},
                        {"refusal", hard.refusal},
                        {"faces", mesh.polygon_count()},
                        {"triangles", mesh.triangle_count()},
                        {"vertices", mesh.positions.size()},
                        {"bytes", bytes.size()}});
  if (common.prints())
    fmt::print("{}: {}; {} faces, {} vertices\n", options.output, hard.what, mesh.polygon_count(),
               mesh.positions.size());
}

void run(const GenerateOptions& options, const CommonOptions& common) {
  check_files(common, {}, {{"--output", options.output, ".ply"}});
  if (options.shape_name.starts_with(hard_prefix)) return generate_hard(options, common);
  const GenerateConfig config{shape_named(options.shape_name), options.triangles.value_or(GenerateConfig{}.triangles),
                              options.seed};
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
  return {OptionSpec{"SHAPE", &o.shape_name,
                     "sphere, terrain, torus, box, pile (of overlapping boxes), or hard:NAME from the catalogue"}
              .must(),
          {"--triangles", &o.triangles,
           "Number of triangles; the nearest regular grid is taken; 1000000 but for hard ones"},
          {"--seed", &o.seed, "Seed of the displacement"},
          OptionSpec{"-o,--output", &o.output, "File to write (.ply)"}.must()};
}

}  // namespace

void add_generate(CommandTable& commands) {
  define_command<GenerateOptions>(commands,
                                  {"generate", "Write a generated surface as binary PLY",
                                   "  lodestone generate sphere --triangles 1000000 --seed 1 -o sphere.ply\n"
                                   "  lodestone generate terrain --triangles 64000000 -o terrain.ply\n"
                                   "  lodestone generate hard:needles -o needles.ply\n"},
                                  declare, run);
}

}  // namespace lodestone
