// Cost per frame of choosing the families of a streamed terrain (ResidentCells::update), without loading them and
// without drawing, camera at rest and moving.
//
// Arguments: levels of the file; budget in percent of what the whole file takes. Counters: cells of the file, families
// that came and went a frame, limits in the last frame. Times are CPU times of the calling thread, loading is not
// timed.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <map>
#include <string>

#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save.h"
#include "render/lod/resident_cells.h"

namespace lodestone {
namespace {

// A terrain with few triangles a cell, removed when the program ends.
struct File {
  explicit File(int finest_level)
      : path(std::filesystem::temp_directory_path() / ("lodestone_bench_" + std::to_string(finest_level) + ".lode")) {
    const auto scheduler = make_tbb_scheduler();
    Repairs repairs;
    BuildConfig config;
    config.simplifier = "cluster";
    config.finest_level = finest_level;
    const GenerateConfig terrain{Shape::terrain, std::uint64_t{12} << (2 * finest_level), 1};
    IndexedMesh mesh = prepare_mesh(generate_mesh(terrain), repairs, *scheduler);
    (void)save_lode(build_hierarchy(std::move(mesh), config, *scheduler), path, *scheduler, LodeForm::plain);
  }
  ~File() { std::filesystem::remove(path); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  std::filesystem::path path;
};

const File& file(std::int64_t finest_level) {
  static std::map<std::int64_t, File> files;
  return files.try_emplace(finest_level, static_cast<int>(finest_level)).first->second;
}

class Flight {
 public:
  explicit Flight(const benchmark::State& state)
      : stream_(file(state.range(0)).path), resident_(stream_, config(state)) {
    RadiiConfig radii;
    radii.kappa0 = 24;
    radii_ = make_radii(stream_.tables(), radii);
  }

  void update(int frame) {
    const float t = 0.001f * static_cast<float>(frame % 1000);
    resident_.update(radii_, {0.1f + 0.8f * t, 0.5f, 0.1f});
    came_ += resident_.came().size(), went_ += resident_.went().size();
  }
  void load() { stream_.wait(); }
  // Frames at one place until nothing has come or gone for long.
  void settle() {
    for (int quiet = 0, frames = 0; quiet < 200 && frames < 3000; ++quiet, ++frames) {
      update(0), load();
      if (!resident_.came().empty() || !resident_.went().empty()) quiet = 0;
    }
    came_ = went_ = 0;
  }

  void report(benchmark::State& state) const {
    const auto frames = static_cast<double>(state.iterations());
    state.counters["cells"] = static_cast<double>(stream_.tables().cells.size());
    state.counters["came"] = static_cast<double>(came_) / frames;
    state.counters["went"] = static_cast<double>(went_) / frames;
    state.counters["limits"] = static_cast<double>(resident_.limits().size());
    state.counters["used"] = static_cast<double>(resident_.bytes()) / static_cast<double>(budget_);
  }

 private:
  ResidencyConfig config(const benchmark::State& state) {
    std::uint64_t all = stream_.family_bytes(no_cell);
    for (CellId c{0}; c < stream_.tables().cells.size(); ++c) all += stream_.family_bytes(c);
    budget_ = all * static_cast<std::uint64_t>(state.range(1)) / 100;
    ResidencyConfig config;
    config.budget_bytes = budget_;
    return config;
  }

  std::uint64_t budget_ = 0;
  CellStream stream_;
  ResidentCells resident_;
  Radii radii_;
  std::size_t came_ = 0, went_ = 0;
};

void at_rest(benchmark::State& state) {
  Flight flight(state);
  flight.settle();
  for (auto _ : state) flight.update(0);
  flight.report(state);
}

void moving(benchmark::State& state) {
  Flight flight(state);
  flight.settle();
  int frame = 0;
  for (auto _ : state) {
    flight.update(++frame);
    state.PauseTiming();
    flight.load();
    state.ResumeTiming();
  }
  flight.report(state);
}

const auto levels = {std::int64_t{4}, std::int64_t{6}, std::int64_t{8}};  // 650, 9,000 and 160,000 cells
const auto percents = {std::int64_t{100}, std::int64_t{30}, std::int64_t{10}};
BENCHMARK(at_rest)->ArgsProduct({levels, percents})->ArgNames({"levels", "percent"})->Unit(benchmark::kMicrosecond);
BENCHMARK(moving)
    ->ArgsProduct({levels, percents})
    ->ArgNames({"levels", "percent"})
    ->Iterations(500)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace lodestone
