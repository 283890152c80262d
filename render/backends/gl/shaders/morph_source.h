// The morph of render/lod/morph.h in GLSL, operation by operation.
#pragma once

#include <string>

#include "render/backends/gl/shaders/draw_program.h"

namespace lodestone {

// morph_lambda() and morph_position(), for code that declares `instance` and `instances`; in the limited variant also
// `limit_range`, which that code sets first.
[[nodiscard]] std::string morph_source(GlVariant variant);

// lambda_of_vertex() of a vertex stage: follows from its position, or is read in the given variant.
[[nodiscard]] std::string lambda_source(GlVariant variant);

}  // namespace lodestone
