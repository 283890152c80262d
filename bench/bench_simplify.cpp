// One level to a quarter, on chunks of 32 thousand triangles: the project's simplifiers and packaged peers in one run.
//
// Rates count input triangles per second of CPU time. Speed never stands without accuracy: rms and max are the
// two-sided distance from the input in its mean edges, kept is the share of the triangles left. What each row may use
// differs and is part of the comparison: the project's own keep locked vertices and the displacement bound, the peers
// do not know the bound, and the cluster ones do not keep the topology.
#include <benchmark/benchmark.h>
#include <meshoptimizer.h>

#include <functional>
#include <string>

#include "bench/peer_openmesh.h"
#include "bench/simplify_chunks.h"
#include "core/simplify/quadric_reference.h"
#include "core/simplify/quadric_simplifier.h"

namespace lodestone::bench {
namespace {

constexpr std::size_t chunk_triangles = 32'000;
constexpr double share = 0.25;
constexpr double displacement_in_edges = 2.5;

std::vector<Chunk> generated(Shape shape, std::size_t triangles) {
  const RawMesh mesh = generate_mesh({shape, 1'000'000, 1});
  std::vector<Vec3f> positions;
  for (const Vec3d& p : mesh.positions) positions.push_back(to_float(p));
  return cut(positions, mesh.triangles, triangles, 4);
}

// The second level: what the first one makes of four times as many triangles is a mesh without any order.
std::vector<Chunk> second_level(Shape shape) {
  std::vector<Chunk> chunks;
  const auto simplifier = make_simplifier(SimplifierKind::quadric);
  for (const Chunk& c : generated(shape, 3 * chunk_triangles))
    chunks.push_back(applied(c, simplifier->simplify(c.input(displacement_in_edges, share))));
  return chunks;
}

const std::vector<Chunk>& chunks_of(const std::string& name) {
  static std::unordered_map<std::string, std::vector<Chunk>> made;
  const auto [at, is_new] = made.try_emplace(name);
  if (is_new && name == "sphere") at->second = generated(Shape::sphere, chunk_triangles);
  if (is_new && name == "terrain") at->second = generated(Shape::terrain, chunk_triangles);
  if (is_new && name == "terrain2") at->second = second_level(Shape::terrain);
  return at->second;
}

using Simplify = std::function<Chunk(const Chunk&)>;

void report(benchmark::State& state, const std::vector<Chunk>& chunks, const Simplify& simplify) {
  double square = 0, worst = 0;
  std::size_t before = 0, after = 0;
  for (const Chunk& c : chunks) {
    const Chunk left = simplify(c);
    const ChunkError e = error_of(c, left);
    square += e.rms * e.rms / static_cast<double>(chunks.size());
    worst = std::max(worst, e.max);
    before += c.triangles.size();
    after += left.triangles.size();
  }
  state.counters["Mtri/s"] =
      benchmark::Counter(static_cast<double>(before) * 1e-6, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["rms"] = std::sqrt(square);
  state.counters["max"] = worst;
  state.counters["kept"] = static_cast<double>(after) / static_cast<double>(before);
}

void run_own(benchmark::State& state, const std::string& data,
             const std::function<std::unique_ptr<Simplifier>()>& make) {
  const std::vector<Chunk>& chunks = chunks_of(data);
  const auto simplifier = make();
  for (auto _ : state)
    for (const Chunk& c : chunks)
      benchmark::DoNotOptimize(simplifier->simplify(c.input(displacement_in_edges, share)).triangles);
  report(state, chunks,
         [&](const Chunk& c) { return applied(c, simplifier->simplify(c.input(displacement_in_edges, share))); });
}

Chunk with_indices(const Chunk& c, const std::vector<unsigned>& indices) {
  Chunk left{c.positions, {}, c.locked, 0};
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
    left.triangles.push_back({{indices[i], indices[i + 1], indices[i + 2]}});
  SimplifyResult all;
  all.positions = c.positions;
  for (std::uint32_t v = 0; v < c.positions.size(); ++v) all.parent.push_back(v);
  return applied(left, all);
}

enum class Meshopt { simplify, sloppy };

std::vector<unsigned> run_meshopt_on(const Chunk& c, Meshopt kind) {
  std::vector<unsigned> out(3 * c.triangles.size());
  const unsigned* in = c.triangles[0].v.data();
  const float* positions = &c.positions[0].x;
  const auto target = static_cast<std::size_t>(share * static_cast<double>(c.triangles.size())) * 3;
  out.resize(kind == Meshopt::sloppy
                 ? meshopt_simplifySloppy(out.data(), in, out.size(), positions, c.positions.size(), sizeof(Vec3f),
                                          target, 1e9f, nullptr)
                 : meshopt_simplify(out.data(), in, out.size(), positions, c.positions.size(), sizeof(Vec3f), target,
                                    1e9f, meshopt_SimplifyLockBorder, nullptr));
  return out;
}

void run_meshopt(benchmark::State& state, const std::string& data, Meshopt kind) {
  const std::vector<Chunk>& chunks = chunks_of(data);
  for (auto _ : state)
    for (const Chunk& c : chunks) benchmark::DoNotOptimize(run_meshopt_on(c, kind).size());
  report(state, chunks, [&](const Chunk& c) { return with_indices(c, run_meshopt_on(c, kind)); });
}

void run_openmesh(benchmark::State& state, const std::string& data) {
  const std::vector<Chunk>& chunks = chunks_of(data);
  for (auto _ : state)
    for (const Chunk& c : chunks) benchmark::DoNotOptimize(decimate_with_openmesh(c, share).size());
  report(state, chunks, [](const Chunk& c) { return with_indices(c, decimate_with_openmesh(c, share)); });
}

void register_all() {
  for (const std::string data : {"sphere", "terrain", "terrain2"}) {
    const auto add = [&](const std::string& name, auto function, auto... arguments) {
      benchmark::RegisterBenchmark((data + "/" + name).c_str(), function, data, arguments...)
          ->Unit(benchmark::kMillisecond);
    };
    add("quadric", run_own, [] { return make_quadric_simplifier(); });
    add("quadric_plain", run_own, [] { return make_quadric_simplifier(InstructionSet::plain); });
    add("meshoptimizer", run_meshopt, Meshopt::simplify);
    add("cluster", run_own, [] { return make_simplifier(SimplifierKind::cluster); });
    add("meshoptimizer_sloppy", run_meshopt, Meshopt::sloppy);
    add("reference", run_own, [] { return make_quadric_reference(); });
    add("openmesh", run_openmesh);
  }
}

const bool registered = (register_all(), true);

}  // namespace
}  // namespace lodestone::bench
