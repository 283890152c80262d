// Holds as much of a model in memory as a budget allows, nearest first, while the camera comes closer.
// usage: stream MODEL.lode MIB
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "lodestone/runtime.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  if (argc != 3) return std::fputs("usage: stream MODEL.lode MIB\n", stderr), 2;
  CellStream stream(argv[1]);  // its thread loads in the background
  ResidentCells resident(stream, {.budget_bytes = static_cast<std::uint64_t>(std::atof(argv[2]) * (1 << 20))});
  const Radii radii = make_radii(resident.hierarchy(), {});
  Selection selection;
  for (int frame = 0; frame < 40; ++frame) {
    const Vec3f eye{0.5f, 0.5f, 3.5f - 0.07f * static_cast<float>(frame)};
    resident.update(radii, eye);
    // Missing cells limit the detail around them. The morph has to get the same limits, or the surface cracks.
    select_cells(resident.hierarchy(), radii, eye, {.limits = resident.limits()}, selection);
    if (frame % 8 == 7)
      std::printf("frame %2d: %zu cells drawn, %llu KiB resident, %s\n", frame, selection.cells.size(),
                  static_cast<unsigned long long>(resident.bytes() >> 10),
                  resident.complete() ? "complete" : "limited");
    stream.wait();  // a frame would not wait; here the output is the same on every machine
  }
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
