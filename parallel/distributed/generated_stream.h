// A generated surface as a stream: a job of many ranks needs no file.
#pragma once

#include <memory>
#include <string_view>

#include "core/mesh/generate.h"
#include "parallel/mesh/mesh_stream.h"

namespace lodestone {

// The same surface as generate_ply writes. Throws InputError for a bad configuration.
[[nodiscard]] std::unique_ptr<MeshStream> generated_stream(const GenerateConfig& config);

// "SHAPE:TRIANGLES" or "SHAPE:TRIANGLES:SEED", such as "sphere:4e9:1". Throws InputError for another text.
[[nodiscard]] GenerateConfig parse_generator(std::string_view text);

}  // namespace lodestone
