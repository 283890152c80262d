// How images lie over octahedral squares (core/spherical/octahedron), as files have it.
#pragma once

#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone {

class Json;
class JsonView;

// true, or {"side": 256, "squares": [[64, 2], [16, 30]]}.
[[nodiscard]] Json to_json(const OctahedralLayout& layout);
// Throws InputError with the place for squares that do not fit.
[[nodiscard]] OctahedralLayout read_octahedral_layout(const JsonView& json);

}  // namespace lodestone
