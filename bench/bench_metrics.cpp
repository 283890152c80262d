// Cost of measuring a frame: cracks in both forms and pops, on a generated sphere seen from close by.
//
// Argument: input triangles. Counter `drawn`: triangles drawn in the frame. Times are CPU times of all workers.
#include <benchmark/benchmark.h>

#include <map>
#include <memory>

#include "core/mesh/generate.h"
#include "experiments/metrics/cracks/crack_basis.h"
#include "experiments/metrics/cracks/cracks.h"
#include "experiments/metrics/pops/pops.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"

namespace {

using namespace lodestone;

// One hierarchy and two neighbouring frames of it, fine enough to draw nearly all of the input.
struct Subject {
  explicit Subject(std::uint64_t triangles) {
    BuildConfig config;
    config.simplifier = "cluster";
    Repairs repairs;
    IndexedMesh mesh = prepare_mesh(generate_mesh({Shape::sphere, triangles, 1}), repairs, *scheduler);
    hierarchy = build_hierarchy(std::move(mesh), config, *scheduler);
    RadiiConfig radii_config;
    radii_config.kappa0 = 8;
    radii = make_radii(hierarchy, radii_config);
    basis = make_crack_basis(hierarchy, *scheduler);
    for (Selection* s : {&before, &after}) {
      select_cells(hierarchy, radii, context(s).viewpoint, {}, *s);
    }
    for (const SelectedCell& s : after.cells) drawn += hierarchy.cells[s.cell].triangles.size();
  }
  [[nodiscard]] MorphContext context(const Selection* s) const {
    return {&hierarchy, &radii, Blend::smoothstep, {0.5f, 0.5f, s == &before ? 1.1f : 1.08f}};
  }

  std::unique_ptr<Scheduler> scheduler = make_tbb_scheduler();
  Hierarchy hierarchy;
  Radii radii;
  std::shared_ptr<const CrackBasis> basis;
  CrackScratch scratch;
  Selection before, after;
  std::uint64_t drawn = 0;
};

Subject& subject(std::uint64_t triangles) {
  static std::map<std::uint64_t, Subject> subjects;
  return subjects.try_emplace(triangles, triangles).first->second;
}

void report(benchmark::State& state, const Subject& s) { state.counters["drawn"] = static_cast<double>(s.drawn); }

void crack_basis(benchmark::State& state) {
  Subject& s = subject(static_cast<std::uint64_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(make_crack_basis(s.hierarchy, *s.scheduler));
  state.counters["boundary_edges"] = static_cast<double>(s.basis->boundary.size());
  state.counters["stored"] = static_cast<double>(s.hierarchy.levels.back().triangles);
}

void chain_form(benchmark::State& state) {
  Subject& s = subject(static_cast<std::uint64_t>(state.range(0)));
  for (auto _ : state) {
    const CrackReport cracks = residual_edges(s.context(&s.after), s.after, *s.basis, *s.scheduler, s.scratch);
    if (cracks.open_edges != 0) state.SkipWithError("the frame cracks");
  }
  report(state, s);
}

void map_form(benchmark::State& state) {
  Subject& s = subject(static_cast<std::uint64_t>(state.range(0)));
  for (auto _ : state) {
    const GapReport gaps = vertex_gaps(s.context(&s.after), s.after, *s.basis, *s.scheduler, s.scratch);
    if (gaps.gaps != 0) state.SkipWithError("the frame cracks");
  }
  report(state, s);
}

void pops(benchmark::State& state) {
  Subject& s = subject(static_cast<std::uint64_t>(state.range(0)));
  for (auto _ : state) {
    const PopReport jump = largest_jump(s.context(&s.before), s.before, s.context(&s.after), s.after, *s.scheduler);
    if (!(jump.jump_over_bound <= 1)) state.SkipWithError("the step pops");
  }
  report(state, s);
}

BENCHMARK(crack_basis)->Arg(2'000'000)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK(chain_form)->Arg(2'000'000)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK(map_form)->Arg(2'000'000)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK(pops)->Arg(2'000'000)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
