// Turns the contents of a file into the mesh that the rest of the program works on, in parallel.
#pragma once

#include <string>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Cleans, welds and normalises (core/mesh/clean.h says what that means, and has the serial twin: same bytes for any
// number of workers). `repairs` is overwritten with the count of everything that was changed. Messages call
// the mesh `name`.
//
// `lattice`: none, one, or Lattice::automatic (core/math/lattice.h); vertices that meet on it are welded.
//
// Consumes raw; its positions are released as soon as they are normalised. Memory at the peak, for V vertices and T
// triangles in all: 37 V + 12 T bytes while normalising, then at most 17 V + 20 T: 30 bytes per triangle when V = T
// / 2.
//
// Throws InputError when no triangle is left or the bounding box is beyond double precision, ResourceError for 2^32
// triangles or more.
[[nodiscard]] IndexedMesh prepare_mesh(RawMesh&& raw, Repairs& repairs, Scheduler& scheduler,
                                       const std::string& name = {}, Lattice lattice = {});

}  // namespace lodestone
