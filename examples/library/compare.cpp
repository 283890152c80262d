// Distances of the input from the levels of its model. usage: compare
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main() try {
  const auto scheduler = make_tbb_scheduler();
  Repairs repairs;
  const RawMesh input = generate_mesh({Shape::torus, 100'000, 1});
  const Hierarchy model = build_hierarchy(prepare_mesh(RawMesh(input), repairs, *scheduler), {}, *scheduler);
  for (int level = 0; level <= model.finest(); ++level) {
    const RawMesh mesh = level_mesh(model, level);
    const MeshDistance distance = compare_meshes(input, mesh, {}, *scheduler);
    std::printf("%7zu triangles: RMS %.3g, largest %.3g, in units of the model\n", mesh.triangles.size(),
                distance.forward.rms, distance.forward.max);
  }
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
