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

// The triangles of a level by cells of the texture.
class TextureGrid {
 public:
  TextureGrid(const ProgressiveMesh& mesh, std::vector<Triangle> level) : mesh_(mesh), level_(std::move(level)) {
    cells_.resize(std::size_t{side} * side);
    for (std::size_t t = 0; t < level_.size(); ++t) {
      Vec2f low{1e9f, 1e9f}, high{-1e9f, -1e9f};
      for (const std::uint32_t v : level_[t].v) {
        const Vec2f p = mesh.wedges.uv[v];
        low = {std::min(low.x, p.x), std::min(low.y, p.y)}, high = {std::max(high.x, p.x), std::max(high.y, p.y)};
      }
      for (int y = cell(low.y); y <= cell(high.y); ++y)
        for (int x = cell(low.x); x <= cell(high.x); ++x)
          cells_[static_cast<std::size_t>(y * side + x)].push_back(static_cast<std::uint32_t>(t));
    }
  }
  // From a vertex to the closest point of its texture coordinates on the level; negative if there is none.
  [[nodiscard]] double distance(std::uint32_t vertex) const {
    const Vec2f p = mesh_.wedges.uv[vertex];
    double best = -1;
    for (const std::uint32_t t : cells_[static_cast<std::size_t>(cell(p.y) * side + cell(p.x))]) {
      double weights[3];
      if (!find(level_[t], p, weights)) continue;
      Vec3d at{};
      for (std::size_t k = 0; k < 3; ++k) at = at + weights[k] * to_double(mesh_.positions[level_[t].v[k]]);
      const double far = length(at - to_double(mesh_.positions[vertex]));
      best = best < 0 ? far : std::min(best, far);
    }
    return best;
  }

 private:
  static constexpr int side = 256;
  static int cell(float x) { return std::clamp(static_cast<int>(x * side), 0, side - 1); }

  [[nodiscard]] bool find(const Triangle& t, Vec2f p, double (&weights)[3]) const {
    const auto area = [](Vec2f a, Vec2f b, Vec2f c) {
      return (double{b.x} - a.x) * (double{c.y} - a.y) - (double{b.y} - a.y) * (double{c.x} - a.x);
    };
    const Vec2f a = mesh_.wedges.uv[t.v[0]], b = mesh_.wedges.uv[t.v[1]], c = mesh_.wedges.uv[t.v[2]];
    const double whole = area(a, b, c);
    weights[0] = area(p, b, c) / whole, weights[1] = area(a, p, c) / whole, weights[2] = area(a, b, p) / whole;
    return std::abs(whole) > 0 && std::min({weights[0], weights[1], weights[2]}) > -1e-9;
  }

  const ProgressiveMesh& mesh_;
  std::vector<Triangle> level_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

void count_deviation(benchmark::State& state, const ProgressiveMesh& mesh) {
  const LevelFinder levels(mesh);
  for (const std::size_t part : {std::size_t{4}, std::size_t{16}, std::size_t{64}}) {
    const std::uint32_t vertices = levels.vertices_for_triangles(mesh.triangles.size() / part);
    const TextureGrid grid(mesh, levels.compute_level(vertices));
    std::vector<double> found;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
      if (const double far = grid.distance(v); far >= 0) found.push_back(far);
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
