// Position maps and what is made of them, on one worker and on two: a generated sphere and its view from above.
//
// First argument: pixels a side. `view_mesh` is what 1 Mpixel in under 50 ms a core speaks of: a map connected and its
// triangles listed. Every rate is items per second, an item being a pixel.
#include <benchmark/benchmark.h>

#include <map>
#include <memory>

#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "render/position_map/map_view.h"
#include "render/position_map/rasterize_map.h"
#include "render/reconstruct/from_maps.h"
#include "render/reconstruct/merge/gather.h"
#include "render/reconstruct/views/condense_map.h"

namespace lodestone {
namespace {

const IndexedMesh& sphere() {
  static const IndexedMesh mesh = [] {
    Repairs repairs;
    const auto serial = make_serial_scheduler();
    return prepare_mesh(generate_mesh({Shape::sphere, 1'000'000, 1}), repairs, *serial);
  }();
  return mesh;
}

MapView view_of_side(std::int64_t side) {
  const Box3f box{{0, 0, 0}, {1, 1, 1}};
  MapView view = orthographic_view(box, {0, 0, -1}, 1.0 / static_cast<double>(side), 0);
  view.width = view.height = static_cast<int>(side);
  return view;
}

const PositionMap& map_of_side(std::int64_t side) {
  static std::map<std::int64_t, PositionMap> maps;
  const auto serial = make_serial_scheduler();
  auto [at, fresh] = maps.try_emplace(side);
  if (fresh) at->second = rasterize_map(sphere(), view_of_side(side), {}, *serial);
  return at->second;
}

void count_pixels(benchmark::State& state, double pixels) {
  state.SetItemsProcessed(static_cast<std::int64_t>(static_cast<double>(state.iterations()) * pixels));
}

void rasterize(benchmark::State& state) {
  const auto scheduler = make_tbb_scheduler(static_cast<int>(state.range(1)));
  const MapView view = view_of_side(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(rasterize_map(sphere(), view, {}, *scheduler));
  count_pixels(state, static_cast<double>(view.pixels()));
}

void view_mesh(benchmark::State& state) {
  const PositionMap& map = map_of_side(state.range(0));
  std::size_t triangles = 0;
  for (auto _ : state) {
    const ViewMesh mesh = connect(map, {});
    std::vector<Triangle> list;
    list.reserve(2 * map.view.pixels());
    list_triangles(mesh, map.view.width, 0, map.view.height, list);
    triangles = list.size();
    benchmark::DoNotOptimize(list.data());
  }
  state.counters["triangles"] = static_cast<double>(triangles);
  count_pixels(state, static_cast<double>(map.view.pixels()));
}

void connect_only(benchmark::State& state) {
  const PositionMap& map = map_of_side(state.range(0));
  const auto scheduler = make_tbb_scheduler(static_cast<int>(state.range(1)));
  MergeView view;
  view.map = &map;
  view.mesh.cells = map.triangle.like<std::uint8_t>();
  const std::vector<RowBlock> blocks = row_blocks(std::span(&view, 1));
  for (auto _ : state)
    for_blocks(blocks, *scheduler,
               [&](const RowBlock& b, std::size_t) { connect_rows(map, {}, b.first, b.last, view.mesh); });
  count_pixels(state, static_cast<double>(map.view.pixels()));
}

void condense(benchmark::State& state) {
  const PositionMap& fine = map_of_side(2 * state.range(0) - 1);
  const MapView view = view_of_side(state.range(0));
  CondensedMap result = condensed_like(fine, view);
  for (auto _ : state) condense_rows(fine, {}, 0, view.height, result);
  count_pixels(state, static_cast<double>(view.pixels()));
}

// Six maps merged.
void merge_faces(benchmark::State& state, MergeKind kind) {
  const auto scheduler = make_tbb_scheduler(static_cast<int>(state.range(1)));
  ReconstructConfig config;
  config.resolution = static_cast<double>(state.range(0));
  config.views.most = config.views.least = 6;
  config.views.candidates = 0;
  config.views.samples = 100;
  config.views.resolution = 16;
  config.merge = kind;
  config.sharp_degrees = 0;
  config.condense = false;
  ReconstructReport report;
  LastChoice last;
  const DrawnMaps drawn = draw_maps(sphere(), config, last, report, *scheduler);
  double seconds = 0;
  for (auto _ : state) {
    DrawnMaps copy = drawn;
    ReconstructReport own = report;
    benchmark::DoNotOptimize(mesh_from_maps(copy, nullptr, config, own, *scheduler));
    state.SetIterationTime(own.merge.seconds);
    seconds += own.merge.seconds;
    state.counters["own_ms"] = 1000 * own.stitch.own.seconds;
    state.counters["zip_ms"] = 1000 * own.stitch.zip.seconds;
  }
  double pixels = 0;
  for (const PositionMap& map : drawn.maps) pixels += static_cast<double>(map.view.pixels());
  count_pixels(state, pixels);
}
void stitch_faces(benchmark::State& state) { merge_faces(state, MergeKind::stitch); }
void concatenate_faces(benchmark::State& state) { merge_faces(state, MergeKind::concatenate); }

BENCHMARK(rasterize)->ArgsProduct({{256, 512, 1024, 2048, 4096}, {1, 2}})->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(connect_only)
    ->ArgsProduct({{256, 512, 1024, 2048, 4096}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(view_mesh)->Arg(256)->Arg(512)->Arg(1024)->Arg(2048)->Arg(4096)->Unit(benchmark::kMillisecond);
BENCHMARK(condense)->Arg(256)->Arg(1024)->Unit(benchmark::kMillisecond);
BENCHMARK(concatenate_faces)->ArgsProduct({{256, 1024}, {1, 2}})->Unit(benchmark::kMillisecond)->UseManualTime();
BENCHMARK(stitch_faces)->ArgsProduct({{256, 512, 1024, 2048}, {1, 2}})->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace lodestone
