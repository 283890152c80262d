// Wavefront OBJ, and its material library (.mtl).
#pragma once

#include "core/files/byte_reader.h"
#include "core/formats/common/mesh_companions.h"
#include "core/formats/common/mesh_view.h"
#include "core/formats/common/read_config.h"

namespace lodestone {

// Reads v and f; indices count from 1, or backwards from the latest value when negative. Attributes: vt, vn, colours
// after positions, usemtl with the libraries of mtllib.
[[nodiscard]] RawMesh read_obj(ByteReader& input, const ReadConfig& config = {});

// A mesh without attributes is written as its vertices and triangles, in their order. One with attributes has each
// position (and colour, "v x y z r g b", without alpha) once, however many wedges it has; texture coordinates and
// normals by wedge; triangles in their order, those without a material first. Materials and images are companions: the
// colour goes to Kd and d, textures to map_Kd and norm, clamping to -clamp; MTL cannot mirror textures, so they are
// repeated. Materials keep names that are unique and fit a line.
void write_obj(AtomicFile& file, const MeshView& mesh, MeshCompanions& companions);

}  // namespace lodestone
