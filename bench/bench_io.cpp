// Reading, cleaning and generating meshes. Bytes per second are of the file, items are triangles.
//
// Files lie in the page cache: what is measured is the program, not the disk. Arguments: threads (0: the general,
// serial reader or the serial twin).
#include <benchmark/benchmark.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "core/formats/mesh_file.h"
#include "core/mesh/clean.h"
#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/generate.h"
#include "parallel/mesh/load.h"

namespace {

using namespace lodestone;

constexpr std::uint64_t triangles = 4'000'000;

std::filesystem::path bench_folder() { return std::filesystem::temp_directory_path() / "lodestone_bench_io"; }

// A terrain of four million triangles in one of the formats, made on first use and kept for the next run.
std::filesystem::path terrain_file(const std::string& extension) {
  const std::filesystem::path path = bench_folder() / ("terrain" + extension);
  if (std::filesystem::exists(path)) return path;
  std::filesystem::create_directories(bench_folder());
  write_mesh(path, generate_mesh({Shape::terrain, triangles, 1}));
  return path;
}

std::unique_ptr<Scheduler> scheduler_of(const benchmark::State& state) {
  return state.range(0) == 0 ? make_serial_scheduler() : make_tbb_scheduler(static_cast<int>(state.range(0)));
}

void count(benchmark::State& state, std::uint64_t items, std::uint64_t bytes) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
  if (bytes != 0) state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}

void load(benchmark::State& state, const std::string& extension) {
  const std::filesystem::path path = terrain_file(extension);
  const auto scheduler = scheduler_of(state);
  std::uint64_t items = 0;
  for (auto _ : state) {
    const RawMesh mesh = state.range(0) == 0 ? read_mesh(path) : load_mesh(path, *scheduler);
    items = mesh.triangles.size();
  }
  count(state, items, std::filesystem::file_size(path));
}

void prepare(benchmark::State& state, Shape shape) {
  const RawMesh raw = generate_mesh({shape, triangles, 1});
  const auto scheduler = scheduler_of(state);
  Repairs repairs;
  for (auto _ : state) {
    state.PauseTiming();
    RawMesh copy = raw;
    state.ResumeTiming();
    const IndexedMesh mesh = prepare_mesh(std::move(copy), repairs, *scheduler);
    benchmark::DoNotOptimize(mesh.triangles.data());
  }
  count(state, raw.triangles.size(), 0);
}

// Every corner a vertex of its own: the worst case of welding.
void prepare_soup(benchmark::State& state) {
  const RawMesh mesh = generate_mesh({Shape::sphere, triangles / 4, 1});
  RawMesh soup;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t id : t.v) soup.positions.push_back(mesh.positions[id]);
  soup.triangles.resize(mesh.triangles.size());
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) soup.triangles[i] = {{3 * i, 3 * i + 1, 3 * i + 2}};
  const auto scheduler = scheduler_of(state);
  Repairs repairs;
  for (auto _ : state) {
    state.PauseTiming();
    RawMesh copy = soup;
    state.ResumeTiming();
    benchmark::DoNotOptimize(prepare_mesh(std::move(copy), repairs, *scheduler).triangles.data());
  }
  count(state, soup.triangles.size(), 0);
}

void clean_serial(benchmark::State& state) {
  const RawMesh raw = generate_mesh({Shape::terrain, triangles / 16, 1});
  Repairs repairs;
  for (auto _ : state) benchmark::DoNotOptimize(clean_mesh(raw, repairs).triangles.data());
  count(state, raw.triangles.size(), 0);
}

void generate(benchmark::State& state, Shape shape) {
  const std::filesystem::path path = bench_folder() / "generated.ply";
  std::filesystem::create_directories(bench_folder());
  const auto scheduler = scheduler_of(state);
  for (auto _ : state) generate_ply({shape, triangles, 1}, path, *scheduler);
  count(state, triangles, std::filesystem::file_size(path));
  std::filesystem::remove(path);
}

#define LODESTONE_IO_BENCHMARK(...)   \
  BENCHMARK_CAPTURE(__VA_ARGS__)      \
      ->Unit(benchmark::kMillisecond) \
      ->MeasureProcessCPUTime()       \
      ->UseRealTime()                 \
      ->ArgName("threads")

LODESTONE_IO_BENCHMARK(load, ply, ".ply")->Arg(0)->Arg(1)->Arg(2);
LODESTONE_IO_BENCHMARK(load, stl, ".stl")->Arg(0)->Arg(2);
LODESTONE_IO_BENCHMARK(load, obj, ".obj")->Arg(0);
LODESTONE_IO_BENCHMARK(prepare, terrain, Shape::terrain)->Arg(0)->Arg(1)->Arg(2);
LODESTONE_IO_BENCHMARK(prepare, sphere, Shape::sphere)->Arg(1);
LODESTONE_IO_BENCHMARK(generate, sphere, Shape::sphere)->Arg(1)->Arg(2);
LODESTONE_IO_BENCHMARK(generate, terrain, Shape::terrain)->Arg(1);
BENCHMARK(prepare_soup)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->ArgName("threads")
    ->Arg(1);
BENCHMARK(clean_serial)->Unit(benchmark::kMillisecond);

}  // namespace
