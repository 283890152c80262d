// The map of closed surfaces to the sphere: generated ones, and real models where scripts/data has put them.
//
// Speed is never given without quality: efficiency by the split measure, flips (0), slivers on the sphere and on the
// surface. Rates count faces per second of CPU time of the map alone: insertion, blocks and sweeps; the collapse before
// it has a counter of its own, in seconds.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/instruction_set.h"
#include "core/math/orientation.h"
#include "core/mesh/generate.h"
#include "parallel/mesh/load.h"
#include "parallel/spherical/map_to_sphere.h"

namespace lodestone {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

RawMesh stretched_ball(std::uint64_t triangles) {
  RawMesh mesh = generate_mesh({Shape::sphere, triangles, 1});
  for (Vec3d& p : mesh.positions) p = (1 / length(p)) * p, p.z *= 100;
  return mesh;
}

// Made or read once; without triangles if there is no such file.
const RawMesh& mesh_of(const std::string& name) {
  static std::map<std::string, RawMesh> meshes;
  const auto [at, is_new] = meshes.try_emplace(name);
  if (!is_new) return at->second;
  const auto scheduler = make_serial_scheduler();
  const std::filesystem::path path = std::filesystem::path(LODESTONE_DATA_DIR) / name;
  if (name.starts_with("sphere_"))
    at->second = generate_mesh({Shape::sphere, std::stoull(name.substr(7)), 1});
  else if (name.starts_with("ball_"))
    at->second = stretched_ball(std::stoull(name.substr(5)));
  else if (std::filesystem::exists(path))
    at->second = load_mesh(path, *scheduler);
  return at->second;
}

SphereMapReport mapped(const RawMesh& mesh, const SphereMapConfig& config, Scheduler& scheduler) {
  SphereMapReport report;
  benchmark::DoNotOptimize(map_to_sphere(mesh.positions, mesh.triangles, config, scheduler, report).data());
  return report;
}

void count(benchmark::State& state, const SphereMapReport& report, double seconds, std::size_t faces) {
  state.counters["faces/s"] = static_cast<double>(faces) / seconds;
  state.counters["efficiency"] = report.sums.efficiency();
  state.counters["flips"] = static_cast<double>(report.sums.flips);
  state.counters["slivers"] = static_cast<double>(report.sums.slivers);
  state.counters["surface_slivers"] = static_cast<double>(report.sums.surface_slivers);
}

void run_map(benchmark::State& state, const std::string& name, SphereMapConfig config) {
  const RawMesh& mesh = mesh_of(name);
  if (mesh.triangles.empty()) return state.SkipWithError("no such model: run scripts/data");
  const auto scheduler = make_serial_scheduler();
  std::vector<double> map, collapse;
  SphereMapReport report;
  for (auto _ : state) {
    report = mapped(mesh, config, *scheduler);
    map.push_back(report.map.cpu_seconds);
    collapse.push_back(report.collapse.cpu_seconds);
  }
  count(state, report, median(map), mesh.triangles.size());
  state.counters["collapse_s"] = median(collapse);
}

// One thread and two in turn, so that whatever else the machine does falls on both alike. The ratio is that of the wall
// times of everything, the collapse and the measure included; it means something on two free cores only.
void run_threads(benchmark::State& state, const std::string& name) {
  const RawMesh& mesh = mesh_of(name);
  const auto one = make_serial_scheduler(), two = make_tbb_scheduler(2);
  std::vector<double> alone, together;
  for (auto _ : state) {
    const Stopwatch first;
    static_cast<void>(mapped(mesh, {}, *one));
    alone.push_back(first.seconds());
    const Stopwatch second;
    static_cast<void>(mapped(mesh, {}, *two));
    together.push_back(second.seconds());
  }
  state.counters["speed_up"] = median(alone) / median(together);
  state.counters["speed_up_of_best"] =
      *std::min_element(alone.begin(), alone.end()) / *std::min_element(together.begin(), together.end());
}

// The predicate where its filter decides, and where it does not.
void run_orientation(benchmark::State& state, bool in_a_plane) {
  const Vec3d a{0.6, 0.8, 0}, b{0, 0.6, 0.8};
  const Vec3d c = in_a_plane ? Vec3d{0.6, 1.4, 0.8} : Vec3d{0.1, 0.3, 0.9};
  for (auto _ : state) benchmark::DoNotOptimize(orientation(a, b, c));
}

void register_all() {
  const auto add = [](const std::string& name, auto function, auto... arguments) {
    return benchmark::RegisterBenchmark(name.c_str(), function, arguments...)->Unit(benchmark::kMillisecond);
  };
  constexpr std::pair<const char*, SphereEffort> efforts[]{
      {"fast", SphereEffort::fast}, {"normal", SphereEffort::normal}, {"best", SphereEffort::best}};
  for (const std::string name :
       {"sphere_100000", "ball_80000", "scans/armadillo.obj", "scans/nefertiti.obj", "scans/igea.ply"})
    for (const auto& [effort, value] : efforts) add(name + "/" + effort, run_map, name, SphereMapConfig{value});
  add("ball_80000/best/guard:1e-7", run_map, std::string("ball_80000"), SphereMapConfig{SphereEffort::best, 1e-7});
  add("sphere_100000/normal/plain", run_map, std::string("sphere_100000"),
      SphereMapConfig{.instructions = InstructionSet::plain});
  for (const std::string name : {"sphere_250000", "sphere_1000000"}) add(name + "/threads", run_threads, name);
  add("sphere_5000000/normal", run_map, std::string("sphere_5000000"), SphereMapConfig{})->Iterations(1);
  add("orientation/filter", run_orientation, false)->Unit(benchmark::kNanosecond);
  add("orientation/exact", run_orientation, true)->Unit(benchmark::kNanosecond);
}

const bool registered = (register_all(), true);

}  // namespace
}  // namespace lodestone
