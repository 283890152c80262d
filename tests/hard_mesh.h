// A surface of the catalogue (core/mesh/hard) as the reader of PLY gives it, no larger than asked for.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "core/files/byte_reader.h"
#include "core/formats/ply/ply.h"
#include "core/mesh/hard/hard_cases.h"

namespace lodestone::test {

inline RawMesh hard_mesh(const HardCase& hard, std::uint64_t most_triangles) {
  const std::string file = hard_ply(hard.make(std::min(hard.size, most_triangles)));
  ByteReader input({file.data(), file.size()}, std::string(hard.name));
  return read_ply(input);
}

}  // namespace lodestone::test
