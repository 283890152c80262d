// Binary PLY (Turk 1994).
#pragma once

#include "core/io/mesh_companions.h"
#include "core/io/mesh_writer.h"

namespace lodestone {

// Per vertex x, y, z and, where the mesh has them, nx, ny, nz, red, green, blue (and alpha where one is not opaque), s
// and t from the lower left corner. Images of base colours are companions, named by "comment TextureFile", and the
// faces say which by "texnumber" (-1: none) where it is not the same for all; other properties of materials are not
// written, PLY has no place for them.
void write_ply(AtomicFile& file, const MeshView& mesh, MeshCompanions& companions);

}  // namespace lodestone
