// Simplifies a whole mesh at once, with another library or with our own kernels: what the levels of a hierarchy and
// reconstructed meshes are compared with.
//
// usage: whole_mesh meshoptimizer|openmesh|quadric|cluster TRIANGLES IN OUT.ply
//
// Reads and cleans the mesh as `lodestone build` does, keeps nothing in place, and prints triangles and seconds of CPU
// time of the simplification alone.
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include "bench/peers.h"
#include "core/formats/mesh_writer.h"
#include "core/simplify/make_simplifier.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/load.h"
#include "parallel/scheduler/cpu_clock.h"

namespace lodestone::bench {
namespace {

// One block without a bound worth the name.
PeerMesh simplify_with(SimplifierKind kind, const PeerMesh& mesh, std::size_t triangles) {
  const std::vector<std::uint8_t> free(mesh.positions.size(), 0);
  const auto simplifier = make_simplifier(kind);
  SimplifyInput input{.positions = mesh.positions, .triangles = mesh.triangles, .locked = free};
  input.max_displacement = 1;
  input.target_triangles = triangles;
  const SimplifyResult& result = simplifier->simplify(input);
  PeerMesh left{result.positions, {}, {}};
  for (const Triangle& t : mesh.triangles) {
    const Triangle image{{result.parent[t.v[0]], result.parent[t.v[1]], result.parent[t.v[2]]}};
    if (!is_degenerate(image)) left.triangles.push_back(image);
  }
  return left;
}

PeerMesh simplify(const std::string& peer, const PeerMesh& mesh, std::size_t triangles) {
  if (peer == "meshoptimizer") return simplify_with_meshoptimizer(mesh, triangles);
  if (peer == "openmesh") return simplify_with_openmesh(mesh, triangles);
  if (peer == "quadric") return simplify_with(SimplifierKind::quadric, mesh, triangles);
  if (peer == "cluster") return simplify_with(SimplifierKind::cluster, mesh, triangles);
  throw std::invalid_argument("unknown peer '" + peer + "'; known are meshoptimizer, openmesh, quadric, cluster");
}

void run(const std::string& peer, std::size_t triangles, const std::string& in, const std::string& out) {
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  const IndexedMesh input = prepare_mesh(load_mesh(in, *scheduler, {.attributes = false}), repairs, *scheduler, in);
  const PeerMesh mesh{input.positions, input.triangles, {}};
  const CpuClock clock;
  const PeerMesh left = simplify(peer, mesh, triangles);
  const double seconds = clock.elapsed().cpu_seconds;
  RawMesh raw;
  for (const Vec3f& p : left.positions) raw.positions.push_back(input.transform.to_model(p));
  raw.triangles = left.triangles;
  write_mesh(out, view_of(raw));
  std::cout << left.triangles.size() << ' ' << seconds << '\n';
}

}  // namespace
}  // namespace lodestone::bench

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: whole_mesh meshoptimizer|openmesh|quadric|cluster TRIANGLES IN OUT.ply\n";
    return 2;
  }
  try {
    lodestone::bench::run(argv[1], std::stoull(argv[2]), argv[3], argv[4]);
  } catch (const std::exception& e) {
    std::cerr << "whole_mesh: " << e.what() << '\n';
    return 1;
  }
}
