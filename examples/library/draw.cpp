// Draws a model at one pixel of error and writes the picture. usage: draw MODEL.lode OUT.png [BACKEND]
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  if (argc < 3 || argc > 4) return std::fputs("usage: draw MODEL.lode OUT.png [BACKEND]\n", stderr), 2;
  const auto scheduler = make_tbb_scheduler();
  const Hierarchy model = load_lode(argv[1], *scheduler);
  const auto renderer = make_renderer(argc == 4 ? argv[3] : "soft", *scheduler);
  renderer->upload(model);

  Frame frame;
  frame.size = {960, 540};
  const Camera camera = orbit_path(model, 8, aspect_of(frame.size)).front();
  const Radii radii = make_radii(model, {.pixel_error = 1, .image_height = frame.size.height});
  ModelFrame& drawn = frame.only();
  drawn.morph = {&model, &radii, Blend::smoothstep, viewpoint(camera, model.transform)};
  drawn.view_projection = view_projection(camera, model, frame.size);
  Selection selection;
  const Frustum frustum = frustum_of(drawn.view_projection);
  select_cells(model, radii, drawn.morph.viewpoint, {&frustum, false}, selection);
  drawn.selection = &selection;

  const FrameStats stats = renderer->draw(frame);
  write_png(argv[2], renderer->read_back());
  std::printf("%llu of %llu triangles\n", static_cast<unsigned long long>(stats.triangles),
              static_cast<unsigned long long>(model.levels.back().triangles));
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
