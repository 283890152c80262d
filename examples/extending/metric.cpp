// A measure of pictures of one's own: the share of edges of the full model's picture that the drawn one lacks. Every
// experiment that compares pictures has it as columns metric_lost-edges and metric_lost-edges_worst.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

namespace {

// A pixel is on an edge where it is much brighter or darker than its neighbour to the right.
bool on_edge(const Image& image, std::size_t pixel) {
  const auto grey = [&](std::size_t p) { return image.rgba[4 * p] + image.rgba[4 * p + 1] + image.rgba[4 * p + 2]; };
  return std::abs(grey(pixel) - grey(pixel + 1)) > 48;
}

double lost_edges(const Image& reference, const Image& test) {
  double edges = 0, lost = 0;
  const auto width = static_cast<std::size_t>(reference.size.width);
  for (std::size_t p = 0; 4 * (p + 1) < reference.rgba.size(); ++p) {
    if ((p + 1) % width == 0 || !on_edge(reference, p)) continue;
    ++edges;
    lost += on_edge(test, p) ? 0 : 1;
  }
  return edges > 0 ? 100 * lost / edges : 0;
}

}  // namespace

int main(int argc, char** argv) try {
  add_picture_metric("lost-edges", {.unit = "%", .meaning = "edges that are lost", .measure = lost_edges});
  return run_program(argc, argv);
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
