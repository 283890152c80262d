// One level to a quarter, on chunks of 32 thousand triangles: the project's simplifiers and packaged peers in one run.
//
// Rates count input triangles per second of CPU time. Speed is never given without accuracy: rms and max are the
// two-sided distance from the input in its mean edges, kept is the share of the triangles left. What each row may use
// differs and is part of the comparison: what has the name of one of our simplifiers keeps locked vertices and the
// displacement bound; what begins with `peer_` is a library as it comes and does not know the bound; the cluster and
// sloppy ones do not keep the topology.
#include <benchmark/benchmark.h>

#include <functional>
#include <string>

#include "bench/peers.h"
#include "bench/simplify_chunks.h"
#include "core/simplify/quadric/quadric_reference.h"
#include "core/simplify/quadric/quadric_simplifier.h"
#include "core/simplify/simplifiers.h"

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
  const auto simplifier = make_simplifier("quadric");
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

PeerMesh peer_mesh(const Chunk& c) { return {c.positions, c.triangles, c.locked}; }

// The mesh that a peer made, with its own vertices.
Chunk chunk_of(const PeerMesh& mesh) {
  const Chunk left{mesh.positions, mesh.triangles, mesh.locked, 0};
  SimplifyResult all;
  all.positions = left.positions;
  for (std::uint32_t v = 0; v < left.positions.size(); ++v) all.parent.push_back(v);
  return applied(left, all);
}

void run_peer(benchmark::State& state, const std::string& data, PeerMesh (*simplify)(const PeerMesh&, std::size_t)) {
  const std::vector<Chunk>& chunks = chunks_of(data);
  std::vector<PeerMesh> meshes;
  for (const Chunk& c : chunks) meshes.push_back(peer_mesh(c));
  const auto target = [](std::size_t triangles) {
    return static_cast<std::size_t>(share * static_cast<double>(triangles));
  };
  for (auto _ : state)
    for (const PeerMesh& m : meshes) benchmark::DoNotOptimize(simplify(m, target(m.triangles.size())).triangles.size());
  report(state, chunks, [&](const Chunk& c) { return chunk_of(simplify(peer_mesh(c), target(c.triangles.size()))); });
}

void register_all() {
  for (const std::string data : {"sphere", "terrain", "terrain2"}) {
    const auto add = [&](const std::string& name, auto function, auto... arguments) {
      benchmark::RegisterBenchmark((data + "/" + name).c_str(), function, data, arguments...)
          ->Unit(benchmark::kMillisecond);
    };
    add("quadric", run_own, [] { return make_quadric_simplifier(); });
    add("quadric_endpoint", run_own, [] { return make_simplifier("quadric", Placement::endpoint); });
    if (is_available(InstructionSet::avx2))
      add("quadric_avx2", run_own, [] { return make_quadric_simplifier(InstructionSet::avx2); });
    add("quadric_plain", run_own, [] { return make_quadric_simplifier(InstructionSet::plain); });
    for (const std::string kind : {"cluster", "meshopt", "openmesh"})
      add(kind, run_own, [kind] { return make_simplifier(kind); });
    add("reference", run_own, [] { return make_quadric_reference(); });
    add("peer_meshoptimizer", run_peer, simplify_with_meshoptimizer);
    add("peer_meshoptimizer_sloppy", run_peer, cluster_with_meshoptimizer);
    add("peer_openmesh", run_peer, simplify_with_openmesh);
#ifdef LODESTONE_HAS_CGAL
    add("peer_cgal", run_peer, simplify_with_cgal);
#endif
  }
}

const bool registered = (register_all(), true);

}  // namespace
}  // namespace lodestone::bench
