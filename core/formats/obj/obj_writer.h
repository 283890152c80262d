// Wavefront OBJ, and its material library (.mtl).
#pragma once

#include "core/files/atomic_file.h"
#include "core/formats/common/mesh_companions.h"
#include "core/formats/common/mesh_view.h"

namespace lodestone {

// A mesh without attributes: its vertices and triangles, in their order. One with attributes: each place (and colour,
// "v x y z r g b", without alpha) once, however many wedges it has; texture coordinates and normals by wedge; triangles
// in their order, those without a material first. Materials and images are companions: the colour goes to Kd and d,
// textures to map_Kd and norm, clamping to -clamp; mirrored textures are repeated, MTL knows no better. Materials get
// the names they have, where these are no two's and fit a line.
void write_obj(AtomicFile& file, const MeshView& mesh, MeshCompanions& companions);

}  // namespace lodestone
