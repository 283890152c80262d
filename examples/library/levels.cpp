// Lists the levels of a model and writes one of them as a mesh. usage: levels MODEL.lode LEVEL OUT.ply
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  if (argc != 4) return std::fputs("usage: levels MODEL.lode LEVEL OUT.ply\n", stderr), 2;
  const auto scheduler = make_tbb_scheduler();
  const Hierarchy model = load_lode(argv[1], *scheduler);
  for (int level = 0; level <= model.finest(); ++level) {
    const Level& l = model.levels[static_cast<std::size_t>(level)];
    // Errors are stored over the cell size of the level, 2^-level of the longest side.
    const double error = static_cast<double>(l.error) * model.transform.scale / (1 << level);
    std::printf("level %d: %5u cells, %9llu triangles, within %.3g of the finest\n", level, l.cell_count,
                static_cast<unsigned long long>(l.triangles), error);
  }
  const RawMesh mesh = level_mesh(model, std::atoi(argv[2]));
  for (const std::string& warning : write_mesh(argv[3], mesh)) std::printf("%s\n", warning.c_str());
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
