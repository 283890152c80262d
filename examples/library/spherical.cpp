// Maps a closed surface to the sphere and unfolds it, so that one texture without a seam serves all levels.
// usage: spherical OUT.glb
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  if (argc != 2) return std::fputs("usage: spherical OUT.glb\n", stderr), 2;
  const auto scheduler = make_tbb_scheduler();
  Repairs repairs;
  const IndexedMesh surface = prepare_mesh(generate_mesh({Shape::sphere, 20'000, 1}), repairs, *scheduler);
  SphericalConfig config;
  config.texture = 256;
  config.on_phase = [](const std::string& phase) { std::printf("%s\n", phase.c_str()); };
  SphericalReport report;
  const ProgressiveMesh mesh = make_spherical(surface, config, *scheduler, report);
  save_progressive(mesh, argv[1]);
  std::printf("efficiency of the map %.2f, normals %.1f dB\n", report.efficiency, report.normal_psnr);
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
