// Writing and opening .lode files, plain and compressed. Bytes per second are of the plain payloads, whichever form the
// file has; items are stored triangles. Files lie in the page cache. Argument: threads.
//
// `unpack` is the codec alone: every cell's payload from memory to memory, without checksum, checks and page faults.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "core/hierarchy/lode/lode_payload.h"
#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save.h"

namespace {

using namespace lodestone;

// One million triangles on a lattice, in the order for compression.
const Hierarchy& model(Shape shape) {
  static std::map<Shape, Hierarchy> models;
  Hierarchy& hierarchy = models[shape];
  if (hierarchy.cells.empty()) {
    const auto scheduler = make_tbb_scheduler();
    Repairs repairs;
    BuildConfig config;
    config.order_cells = true;
    hierarchy = build_hierarchy(
        prepare_mesh(generate_mesh({shape, 1'000'000, 1}), repairs, *scheduler, {}, {Lattice::automatic}), config,
        *scheduler);
  }
  return hierarchy;
}

struct Stored {
  std::uint64_t bytes = 0, triangles = 0;
};

Stored stored_in(const Hierarchy& hierarchy) {
  Stored stored;
  for (const Cell& cell : hierarchy.cells) {
    stored.bytes += plain_bytes(counts_of(cell));
    stored.triangles += cell.triangles.size();
  }
  return stored;
}

void count(benchmark::State& state, const Hierarchy& hierarchy, std::uint64_t file_bytes) {
  const Stored stored = stored_in(hierarchy);
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(stored.bytes));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(stored.triangles));
  state.counters["file_bytes_per_triangle"] = static_cast<double>(file_bytes) / static_cast<double>(stored.triangles);
}

class BenchFile {
 public:
  BenchFile()
      : path_(std::filesystem::temp_directory_path() / ("lodestone_bench_" + std::to_string(::getpid()) + ".lode")) {}
  ~BenchFile() { std::filesystem::remove(path_); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void save(benchmark::State& state, Shape shape, LodeForm form) {
  const Hierarchy& hierarchy = model(shape);
  const auto scheduler = make_tbb_scheduler(static_cast<int>(state.range(0)));
  const BenchFile file;
  std::uint64_t bytes = 0;
  for (auto _ : state) bytes = save_lode(hierarchy, file.path(), *scheduler, form);
  count(state, hierarchy, bytes);
}

void load(benchmark::State& state, Shape shape, LodeForm form) {
  const Hierarchy& hierarchy = model(shape);
  const auto scheduler = make_tbb_scheduler(static_cast<int>(state.range(0)));
  const BenchFile file;
  const std::uint64_t bytes = save_lode(hierarchy, file.path(), *scheduler, form);
  for (auto _ : state) benchmark::DoNotOptimize(load_lode(file.path(), *scheduler).cells.data());
  count(state, hierarchy, bytes);
}

void unpack(benchmark::State& state, Shape shape) {
  const Hierarchy& hierarchy = model(shape);
  const Lattice lattice = hierarchy.transform.lattice;
  std::vector<std::vector<std::byte>> packed;
  std::uint64_t packed_bytes = 0, largest = 0;
  for (const Cell& cell : hierarchy.cells) {
    compress_payload(cell, lattice, packed.emplace_back());
    packed_bytes += packed.back().size();
    largest = std::max(largest, plain_bytes(counts_of(cell)));
  }
  std::vector<std::byte> out(largest);
  for (auto _ : state)
    for (std::size_t c = 0; c < packed.size(); ++c) {
      const PayloadCounts n = counts_of(hierarchy.cells[c]);
      if (decompress_payload(packed[c], n, lattice, std::span(out).first(plain_bytes(n))))
        state.SkipWithError("broken");
    }
  count(state, hierarchy, packed_bytes);
}

#define LODESTONE_LODE_BENCHMARK(...) \
  BENCHMARK_CAPTURE(__VA_ARGS__)      \
      ->Unit(benchmark::kMillisecond) \
      ->MeasureProcessCPUTime()       \
      ->UseRealTime()                 \
      ->ArgName("threads")            \
      ->Arg(1)                        \
      ->Arg(2)

LODESTONE_LODE_BENCHMARK(save, sphere_plain, Shape::sphere, LodeForm::plain);
LODESTONE_LODE_BENCHMARK(save, sphere_compressed, Shape::sphere, LodeForm::compressed);
LODESTONE_LODE_BENCHMARK(load, sphere_plain, Shape::sphere, LodeForm::plain);
LODESTONE_LODE_BENCHMARK(load, sphere_compressed, Shape::sphere, LodeForm::compressed);
LODESTONE_LODE_BENCHMARK(load, terrain_compressed, Shape::terrain, LodeForm::compressed);
BENCHMARK_CAPTURE(unpack, sphere, Shape::sphere)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(unpack, terrain, Shape::terrain)->Unit(benchmark::kMillisecond);

}  // namespace
