// Progressive meshes by each metric: generated spheres over the octahedral square, and textured models where
// scripts/data has put them.
//
// Speed is never given without quality: the deviation on the texture of levels of a fourth, a sixteenth and a 64th of
// the triangles, measured by looking up the texture coordinates of all vertices in the level. Rates count faces per
// second of CPU time of everything, one thread or several.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/mesh/generate.h"
#include "core/progressive/mesh/level.h"
#include "experiments/metrics/geometry/level_on_texture.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/load.h"
#include "parallel/progressive/make_progressive.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

using progressive::MetricKind;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The place of a direction in the square, on the face of the octahedron that `side` points to.
Vec2f octahedral(Vec3d p, Vec3d side) {
  const double sum = std::abs(p.x) + std::abs(p.y) + std::abs(p.z);
  double u = p.x / sum, v = p.y / sum;
  if (side.z < 0) {
    const double across = std::copysign(1 - std::abs(v), side.x), along = std::copysign(1 - std::abs(u), side.y);
    u = across, v = along;
  }
  return {static_cast<float>(0.5 + 0.5 * u), static_cast<float>(0.5 + 0.5 * v)};
}

// A cube-sphere of an even number of squares along the side, so that no triangle crosses the octahedron's edges.
RawMesh textured_sphere(std::uint64_t triangles) {
  const auto half = static_cast<std::uint64_t>(std::lround(std::sqrt(static_cast<double>(triangles) / 48)));
  RawMesh mesh = generate_mesh({Shape::sphere, 48 * half * half, 1});
  for (const Triangle& t : mesh.triangles) {
    const Vec3d side = mesh.positions[t.v[0]] + mesh.positions[t.v[1]] + mesh.positions[t.v[2]];
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners.v[k] = static_cast<std::uint32_t>(mesh.wedges.uv.size());
      mesh.wedges.uv.push_back(octahedral(mesh.positions[t.v[k]], side));
    }
    mesh.wedges.corners.push_back(corners);
  }
  return mesh;
}

// Made or read once; without triangles if there is no such file.
const IndexedMesh& mesh_of(const std::string& name) {
  static std::map<std::string, IndexedMesh> meshes;
  const auto [at, is_new] = meshes.try_emplace(name);
  if (!is_new) return at->second;
  const auto scheduler = make_serial_scheduler();
  const std::filesystem::path path = std::filesystem::path(LODESTONE_DATA_DIR) / name;
  RawMesh raw;
  if (name.starts_with("sphere_"))
    raw = textured_sphere(std::stoull(name.substr(7)));
  else if (std::filesystem::exists(path))
    raw = load_mesh(path, *scheduler, {.attributes = true});
  raw.wedges.normal.clear();
  if (raw.triangles.empty()) return at->second;
  Repairs repairs;
  return at->second = prepare_mesh(std::move(raw), repairs, *scheduler);
}

void count_deviation(benchmark::State& state, const ProgressiveMesh& mesh) {
  const LevelFinder levels(mesh);
  for (const std::size_t part : {std::size_t{4}, std::size_t{16}, std::size_t{64}}) {
    const std::uint32_t vertices = levels.vertices_for_triangles(mesh.triangles.size() / part);
    const std::vector<Triangle> triangles = levels.compute_level(vertices);
    const LevelOnTexture level(mesh, triangles);
    std::vector<double> found;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
      if (const double far = level.distance(to_double(mesh.positions[v]), on_texture(mesh, VertexId(v)));
          std::isfinite(far))
        found.push_back(far);
    double squares = 0;
    for (const double far : found) squares += far * far;
    const auto high = found.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(found.size() - 1));
    std::nth_element(found.begin(), high, found.end());
    const std::string of = "_" + std::to_string(part);
    state.counters["rms" + of] = std::sqrt(squares / static_cast<double>(found.size()));
    state.counters["p999" + of] = *high;
  }
}

void run_progressive(benchmark::State& state, const std::string& name, MetricKind metric, int threads) {
  const IndexedMesh& mesh = mesh_of(name);
  if (mesh.triangles.empty()) return state.SkipWithError("no such model: run scripts/data");
  const auto scheduler = threads == 1 ? make_serial_scheduler() : make_tbb_scheduler(threads);
  std::vector<double> wall, cpu;
  ProgressiveMesh out;
  ProgressiveReport report;
  for (auto _ : state) {
    const CpuClock clock;
    out = make_progressive(mesh, {.metric = metric}, *scheduler, report);
    const StageTime time = clock.elapsed();
    wall.push_back(time.seconds), cpu.push_back(time.cpu_seconds);
  }
  const auto faces = static_cast<double>(mesh.triangles.size());
  state.counters["faces/core_s"] = faces / median(cpu);
  state.counters["faces/s"] = faces / median(wall);
  state.counters["base"] = static_cast<double>(report.base_triangles);
  count_deviation(state, out);
}

void register_all() {
  const std::string models[]{"sphere_100000",
                             "sphere_300000",
                             "sphere_1000000",
                             "textured/Hermes/Hermes.obj",
                             "textured/Gutenberg/Gutenberg.obj",
                             "textured/meshroom_esp32cam/texturedMesh.obj",
                             "textured/spot/spot_triangulated.obj"};
  for (const std::string& name : models)
    for (const MetricKind metric : {MetricKind::quadric, MetricKind::attribute_quadric, MetricKind::parametric})
      for (const int threads : {1, 2})
        benchmark::RegisterBenchmark(
            (name + "/" + std::string(name_of(metric)) + "/threads:" + std::to_string(threads)).c_str(),
            run_progressive, name, metric, threads)
            ->Unit(benchmark::kMillisecond);
}

const bool registered = (register_all(), true);

}  // namespace
}  // namespace lodestone
