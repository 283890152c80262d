// Builds a hierarchy of arrays of one's own and writes it. usage: own_mesh OUT.lode
#include <cmath>
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  if (argc != 2) return std::fputs("usage: own_mesh OUT.lode\n", stderr), 2;
  // A height field of 400 x 400 posts, in any unit: positions are normalised, and welded where they are equal.
  constexpr std::uint32_t side = 400;
  RawMesh raw;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const double x = i % side, y = i / side;
    raw.positions.push_back({x, y, 12 * std::sin(x / 15) * std::cos(y / 21)});
  }
  for (std::uint32_t i = 0; i + side < side * side; ++i) {
    if (i % side == side - 1) continue;
    raw.triangles.push_back({{i, i + 1, i + side + 1}});
    raw.triangles.push_back({{i, i + side + 1, i + side}});
  }
  const auto scheduler = make_tbb_scheduler();
  Repairs repairs;
  IndexedMesh mesh = prepare_mesh(std::move(raw), repairs, *scheduler);
  const Hierarchy hierarchy = build_hierarchy(std::move(mesh), {}, *scheduler);
  const std::uint64_t bytes = save_lode(hierarchy, argv[1], *scheduler);
  std::printf("%d levels, %llu bytes\n", hierarchy.finest() + 1, static_cast<unsigned long long>(bytes));
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
