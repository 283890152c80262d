// Triangles that fill holes, for the time that a surface has to be closed.
#pragma once

#include <cstdint>
#include <span>

#include "core/spherical/surface.h"
#include "core/spherical/topology/sides.h"

namespace lodestone::spherical {

// Fills one loop; the new triangles run along it from each vertex to the next. A loop of up to 12 vertices gets a fan
// around its centre. A longer one gets a ring of half as many vertices inside, each a step of the loop's mean edge
// nearer to the centre, and so on: about three triangles per vertex, and no vertex of a large valence. They need not
// lie in any plane and may meet other parts of the surface.
void fill_loop(Surface& surface, std::span<const Id> loop);

struct FilledHoles {
  std::uint64_t loops = 0;
  std::uint64_t triangles = 0;  // added
};

// Fills all border loops of an oriented manifold.
FilledHoles fill_holes(Surface& surface);

}  // namespace lodestone::spherical
