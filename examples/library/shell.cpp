// Wraps overlapping parts in one closed surface: what can be seen from outside. usage: shell OUT.ply
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  if (argc != 2) return std::fputs("usage: shell OUT.ply\n", stderr), 2;
  const auto scheduler = make_tbb_scheduler();
  Repairs repairs;
  const IndexedMesh parts = prepare_mesh(generate_mesh({Shape::pile, 12'000, 1}), repairs, *scheduler);
  ReconstructConfig config;
  config.merge = MergeKind::shell;
  config.resolution = 96;  // samples along the longest side
  config.triangles = 5000;
  const Reconstruction shell = reconstruct(parts, config, *scheduler);
  (void)write_mesh(argv[1], shell.mesh);
  std::printf("%zu triangles of 1,000 boxes -> %zu of one shell\n", parts.triangles.size(),
              shell.mesh.triangles.size());
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
