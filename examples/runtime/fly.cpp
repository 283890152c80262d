// Flies towards a model and says how many triangles each frame draws. usage: fly MODEL.lode
#include <cstdio>
#include <exception>
#include <vector>

#include "lodestone/runtime.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  if (argc != 2) return std::fputs("usage: fly MODEL.lode\n", stderr), 2;
  const Hierarchy model = open_lode(argv[1]);
  // One pixel of a picture 720 pixels high. A camera of another field of view needs radii of its own.
  const Radii radii = make_radii(model, {.pixel_error = 1, .image_height = 720});
  Selection selection;
  std::vector<Vec3f> drawn;
  for (int frame = 0; frame <= 8; ++frame) {
    // In normalised space the model lies in the unit cube.
    const Vec3f eye{0.5f, 0.5f, 0.6f + 3.0f * static_cast<float>(8 - frame) / 8};
    select_cells(model, radii, eye, {}, selection);
    const MorphContext context{&model, &radii, Blend::smoothstep, eye};
    std::size_t triangles = 0, morphing = 0;
    for (const SelectedCell& selected : selection.cells) {
      const Cell& cell = model.cells[selected.cell];
      drawn.resize(cell.positions.size());
      morph_cell(context, selected.cell, drawn);  // what a vertex shader gets, with cell.triangles as indices
      triangles += cell.triangles.size();
      morphing += selected.morphing ? 1 : 0;
    }
    std::printf("height %.2f: %zu cells, %zu of them morphing, %zu triangles\n", eye.z, selection.cells.size(),
                morphing, triangles);
  }
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
