// Builds one after the other in one process: memory must not grow. usage: soak_builds NUMBER
#include <algorithm>

#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save.h"
#include "tests/soak.h"

namespace {

using namespace lodestone;
using namespace lodestone::soak;

void build(int number, const fs::path& folder, Scheduler& scheduler) {
  constexpr Shape shapes[] = {Shape::sphere, Shape::terrain, Shape::torus, Shape::pile};
  constexpr Strategy strategies[] = {Strategy::graph, Strategy::levels, Strategy::serial};
  BuildConfig config;
  config.finest_level = 3;
  config.strategy = strategies[number % 3];
  config.simplifier = number % 5 == 0 ? "cluster" : "quadric";
  config.order_cells = number % 2 == 0;
  Repairs repairs;
  IndexedMesh mesh = prepare_mesh(generate_mesh({shapes[number % 4], 8000, 5}), repairs, scheduler);
  const Hierarchy hierarchy = build_hierarchy(std::move(mesh), config, scheduler);
  (void)save_lode(hierarchy, folder / "m.lode", scheduler);
  if (load_lode(folder / "m.lode", scheduler).cells.size() != hierarchy.cells.size()) fail("a file has other cells");
}

void build_many(int builds, const fs::path& folder, Scheduler& scheduler) {
  constexpr int cycle = 60;  // after which the parameters are those of the beginning
  for (int i = 0; i < cycle; ++i) build(i, folder, scheduler);
  Growth growth(std::uint64_t{1} << 18, std::uint64_t{1} << 20);
  growth.middle();
  const int cycles = std::max(1, builds / cycle);
  for (int c = 0; c < cycles; ++c) {
    for (int i = 0; i < cycle; ++i) build(i, folder, scheduler);
    if (c == cycles / 2) growth.middle();
  }
  std::printf("%d builds\n", (cycles + 1) * cycle);
  growth.end();
}

}  // namespace

int main(int argc, char** argv) {
  const int builds = argc == 2 ? std::atoi(argv[1]) : 0;
  if (builds <= 0) {
    std::fputs("usage: soak_builds NUMBER\n", stderr);
    return 2;
  }
  return run([&](const fs::path& folder, Scheduler& scheduler) { build_many(builds, folder, scheduler); });
}
