// A progressive mesh: any number of triangles from one file. usage: progressive OUT.lpm
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  if (argc != 2) return std::fputs("usage: progressive OUT.lpm\n", stderr), 2;
  const auto scheduler = make_tbb_scheduler();
  Repairs repairs;
  IndexedMesh input = prepare_mesh(generate_mesh({Shape::torus, 60'000, 1}), repairs, *scheduler);
  ProgressiveReport report;
  save_progressive(make_progressive(std::move(input), {}, *scheduler, report), argv[1]);

  const ProgressiveMesh mesh = load_progressive(argv[1]);
  const LevelFinder levels(mesh);
  for (const std::size_t triangles : {500, 5000, 50'000}) {
    const std::uint32_t vertices = levels.vertices_for_triangles(triangles);
    std::printf("%6zu triangles: %5u vertices, %.3g of the model's size away\n", levels.triangles_of(vertices),
                vertices, static_cast<double>(levels.error_of(vertices)));
  }
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
