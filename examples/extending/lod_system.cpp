// An LOD system of one's own, for the experiment `systems`: the usual cells, but the morph of the vertices is rounded
// to quarters, as an engine with few morph targets would have it.
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  // A staircase that is nearly one: curves are continuous, so each step rises over a sixteenth of the band.
  BlendCurve stairs{BlendCurve::Kind::table, {}};
  for (int i = 0; i <= 16; ++i) stairs.values.push_back(static_cast<float>((i + 2) / 4) / 4);
  stairs.values.front() = 0, stairs.values.back() = 1;
  const Blend quarters = own_blend(stairs);
  add_lod_system("quarters", {.description = "cells by distance, vertices morphed in four steps",
                              .parts =
                                  [quarters](const SystemQuery& query) {
                                    return std::vector<SystemPart>{{query.radii, quarters}};
                                  },
                              .keeps_promise = true});
  return run_program(argc, argv);
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
