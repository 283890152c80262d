// Cost of octahedral images: the map of points between square and sphere, unfolding, resampling.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/mesh/generate.h"
#include "core/mesh/up_axis.h"
#include "core/spherical/octahedron/cut_choice.h"
#include "core/spherical/octahedron/octahedral_map.h"
#include "core/spherical/octahedron/sphere_raster.h"
#include "core/spherical/octahedron/unfold.h"
#include "core/spherical/resample/resampler.h"
#include "core/spherical/topology/make_spheres.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/load.h"
#include "parallel/scheduler/clock.h"
#include "parallel/spherical/map_to_sphere.h"

namespace {

using namespace lodestone;
using namespace lodestone::spherical;

constexpr std::size_t points = 4096;

// A generated sphere, and the directions of its vertices from its centre.
struct Subject {
  RawMesh mesh = generate_mesh({Shape::sphere, 200'000, 1});
  std::vector<Vec3d> directions;

  Subject() {
    for (const Vec3d& p : mesh.positions) {
      const Vec3d d = p - Vec3d{0.5, 0.5, 0.5};
      directions.push_back((1 / length(d)) * d);
    }
  }
};
const Subject& subject() {
  static const Subject only;
  return only;
}

void square_to_sphere(benchmark::State& state) {
  std::mt19937_64 random(1);
  const auto number = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<SquarePoint> from(points);
  for (SquarePoint& p : from) p = {number(), number()};
  std::vector<Vec3d> to(points);
  for (auto _ : state) {
    for (std::size_t i = 0; i < points; ++i) to[i] = direction_of(from[i]);
    benchmark::DoNotOptimize(to.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points));
}

void sphere_to_square(benchmark::State& state) {
  const std::vector<Vec3d>& from = subject().directions;
  std::vector<SquarePoint> to(points);
  for (auto _ : state) {
    for (std::size_t i = 0; i < points; ++i) to[i] = square_point(from[i]);
    benchmark::DoNotOptimize(to.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points));
}

// Items are triangles.
void unfolding(benchmark::State& state) {
  const Subject& s = subject();
  for (auto _ : state) benchmark::DoNotOptimize(unfold(s.mesh.triangles, s.directions));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(s.mesh.triangles.size()));
}

// The generated sphere with a texture: longitude and latitude, a triangle at the back in one piece with wedges of its
// own.
struct Textured {
  IndexedMesh mesh;
  Surface surface;

  Textured() {
    const Subject& s = subject();
    surface.positions = s.mesh.positions;
    surface.triangles = s.mesh.triangles;
    for (std::uint32_t v = 0; v < surface.positions.size(); ++v) {
      const Vec3d d = s.directions[v];
      surface.source_vertex.push_back(v);
      mesh.positions.push_back(to_float(surface.positions[v]));
      mesh.wedges.vertex.push_back(v);
      mesh.wedges.uv.push_back({static_cast<float>(std::atan2(d.y, d.x) / 6.283185307179586 + 0.5),
                                static_cast<float>(std::acos(std::clamp(d.z, -1.0, 1.0)) / 3.141592653589793)});
    }
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      surface.source_triangle.push_back(t);
      mesh.triangles.push_back(at_front(surface.triangles[t]));
    }
    PixelImage image{.size = {2048, 1024}, .channels = 3, .pixels = {}};
    for (std::uint32_t i = 0; i < 3 * 2048 * 1024; ++i)
      image.pixels.push_back(static_cast<std::uint8_t>((i / 3 % 2048) ^ (i / 6144)));
    Texture& texture = mesh.wedges.textures.emplace_back();
    texture.media_type = "image/png";
    texture.bytes = encode_image(image, texture.media_type);
    mesh.wedges.materials.emplace_back().texture = 0;
  }

  // The triangle with coordinates on one side of the seam.
  Triangle at_front(Triangle triangle) {
    float least = 1, most = 0;
    for (const std::uint32_t v : triangle.v)
      least = std::min(least, mesh.wedges.uv[v].x), most = std::max(most, mesh.wedges.uv[v].x);
    if (most - least < 0.5f) return triangle;
    for (std::uint32_t& v : triangle.v) {
      if (mesh.wedges.uv[v].x > 0.5f) continue;
      const Vec2f uv = mesh.wedges.uv[v];
      mesh.positions.push_back(mesh.positions[v]);
      mesh.wedges.vertex.push_back(v);
      mesh.wedges.uv.push_back({uv.x + 1, uv.y});
      v = static_cast<std::uint32_t>(mesh.positions.size() - 1);
    }
    return triangle;
  }
};

// Items are pixels, 2 x 2 samples each, all steps included; the argument is the size, and 1 for normals besides.
void resampling(benchmark::State& state) {
  static const Textured textured;
  const auto mesh = std::make_shared<MeshSource>(textured.mesh);
  mesh->load(0);
  const SurfaceSource source(mesh, textured.surface, subject().directions);
  const ResampleConfig config{
      .size = static_cast<std::uint32_t>(state.range(0)), .sides = 2, .normals = state.range(1) != 0};
  for (auto _ : state) benchmark::DoNotOptimize(resample(textured.surface, subject().directions, source, config));
  state.SetItemsProcessed(state.iterations() * state.range(0) * state.range(0));
}

// Items are samples of 2048 x 2048, all steps included.
void covering(benchmark::State& state) {
  const Subject& s = subject();
  constexpr std::uint32_t n = 2048;
  SampleTile tile;
  for (auto _ : state) {
    SphereRaster raster(s.mesh.triangles, s.directions, {n, SampleGrid::Placing::in_cells});
    raster.prepare();
    for (std::size_t k = 0; k < raster.tile_count(); ++k) {
      raster.cover(k, tile);
      benchmark::DoNotOptimize(tile.triangle.data());
    }
  }
  state.SetItemsProcessed(state.iterations() * std::int64_t{n} * n);
}

// The largest component of a textured scan, as `lodestone spherical` maps it; without triangles if there is no file.
struct Scan {
  IndexedMesh mesh;
  Surface surface;
  std::vector<Vec3d> directions;

  explicit Scan(const std::string& file) {
    const std::filesystem::path path = std::filesystem::path(LODESTONE_DATA_DIR) / file;
    if (!std::filesystem::exists(path)) return;
    const auto scheduler = make_serial_scheduler();
    Repairs repairs;
    mesh = prepare_mesh(load_mesh(path, *scheduler), repairs, *scheduler);
    Spheres spheres = make_spheres(mesh);
    surface = std::move(*std::ranges::max_element(spheres.surfaces, {},
                                                  [](const Surface& component) { return component.triangles.size(); }));
    SphereMapReport report;
    directions = map_to_sphere(surface.positions, surface.triangles, {}, *scheduler, report);
    directions = rotated(directions, CutMeasure(surface.positions, surface.triangles, directions).choose().rotation);
  }
};

const Scan& scan(const std::string& file) {
  static std::map<std::string, std::unique_ptr<Scan>> scans;
  std::unique_ptr<Scan>& kept = scans[file];
  if (!kept) kept = std::make_unique<Scan>(file);
  return *kept;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// Colours and normals of a scan; a pixel is one place of both images. `drawn` counts all that makes the images from
// loaded textures, `whole` the textures' decoding and levels besides; both are medians of processor time.
void resampling_scan(benchmark::State& state, const std::string& file) {
  const Scan& subject = scan(file);
  if (subject.surface.triangles.empty()) return state.SkipWithError("no such model: run scripts/data");
  const ResampleConfig config{.size = static_cast<std::uint32_t>(state.range(0))};
  std::vector<double> loading, preparing, placing, drawing, finishing, drawn;
  const auto add = [](std::vector<double>& to, double& since) {
    const double now = thread_cpu_seconds();
    to.push_back(now - since);
    since = now;
  };
  for (auto _ : state) {
    double since = thread_cpu_seconds();
    const auto mesh = std::make_shared<MeshSource>(subject.mesh);
    for (std::size_t t = 0; t < mesh->texture_count(); ++t) mesh->load(t);
    add(loading, since);
    const double begin = since;
    const SurfaceSource source(mesh, subject.surface, subject.directions);
    Resampler resampler(subject.surface, subject.directions, source, config);
    add(preparing, since);
    resampler.raster().prepare();
    add(placing, since);
    SampleTile room;
    for (std::size_t tile = 0; tile < resampler.raster().tile_count(); ++tile) resampler.draw(tile, room);
    add(drawing, since);
    benchmark::DoNotOptimize(resampler.finish());
    add(finishing, since);
    drawn.push_back(since - begin);
  }
  const double megapixels = static_cast<double>(config.size) * config.size / 1e6;
  state.counters["drawn_mpixel/s"] = megapixels / median(drawn);
  state.counters["whole_mpixel/s"] = megapixels / (median(drawn) + median(loading));
  state.counters["load_ms"] = 1e3 * median(loading);
  state.counters["source_ms"] = 1e3 * median(preparing);
  state.counters["place_ms"] = 1e3 * median(placing);
  state.counters["draw_ms"] = 1e3 * median(drawing);
  state.counters["finish_ms"] = 1e3 * median(finishing);
}

constexpr const char *hermes = "textured/Hermes/Hermes.obj", *gutenberg = "textured/Gutenberg/Gutenberg.obj",
                     *shepherd = "textured/ShepherdBoy/ShepherdBoy.obj", *nymph = "textured/Nymph/Nymph.obj";
BENCHMARK_CAPTURE(resampling_scan, hermes, hermes)->Arg(1024)->Arg(2048)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(resampling_scan, gutenberg, gutenberg)->Arg(1024)->Arg(2048)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(resampling_scan, shepherd, shepherd)->Arg(1024)->Arg(2048)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(resampling_scan, nymph, nymph)->Arg(1024)->Arg(2048)->Unit(benchmark::kMillisecond);
BENCHMARK(square_to_sphere);
BENCHMARK(sphere_to_square);
BENCHMARK(covering)->Unit(benchmark::kMillisecond);
BENCHMARK(resampling)->Args({1024, 0})->Args({2048, 0})->Args({2048, 1})->Unit(benchmark::kMillisecond);
BENCHMARK(unfolding)->Unit(benchmark::kMillisecond);

}  // namespace
