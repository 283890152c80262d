// An experiment of one's own, which `experiment experiments` lists and `experiment sweep` runs: how the triangles of a
// level depend on the cell size.
#include <cmath>
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

namespace {

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const auto scheduler = make_tbb_scheduler(parameters.integer("threads"));
  Repairs repairs;
  BuildConfig config;
  config.cell_triangles = static_cast<std::uint32_t>(parameters.integer("cell_triangles"));
  config.cancel = context.cancel;
  IndexedMesh mesh = prepare_mesh(load_mesh(context.input, *scheduler), repairs, *scheduler, context.input);
  const CpuClock clock;
  const Hierarchy model = build_hierarchy(std::move(mesh), config, *scheduler);
  const StageTime time = clock.elapsed();
  const double coarsest = static_cast<double>(model.levels.front().triangles);
  const double finest = static_cast<double>(model.levels.back().triangles);
  return {{{"levels", model.finest() + 1},
           {"reduction", model.finest() > 0 ? std::pow(coarsest / finest, 1.0 / model.finest()) : 1.0},
           {"cpu_seconds", time.cpu_seconds}}};
}

// A level has a quarter of the next finer one's triangles at best.
std::vector<std::string> verify(const Parameters&, const std::vector<Row>& rows) {
  std::vector<std::string> faults;
  for (const Row& row : rows)
    if (const double reduction = row.at("reduction").get<double>(); !(reduction > 0.2 && reduction <= 1))
      faults.push_back("a level has " + std::to_string(reduction) + " of the next finer one's triangles");
  return faults;
}

}  // namespace

int main(int argc, char** argv) try {
  using enum ColumnInfo::Kind;
  add_experiment({.name = "reduction",
                  .question = "How much smaller is each level than the next finer one?",
                  .parameters = {{"threads", 1, "", "workers", 0, 4096, {}},
                                 {"cell_triangles", 1200, "", "mean triangles per finest cell", 1, 1e9, {}}},
                  .columns = {{"levels", "", "of the hierarchy", count},
                              {"reduction", "", "triangles of a level over those of the next finer one", accuracy},
                              {"cpu_seconds", "s", "of the build", cost}},
                  .run = run,
                  .verify = verify});
  return run_program(argc, argv);
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
