// OFF, the object file format of Geomview.
#pragma once

#include "core/files/byte_reader.h"
#include "core/formats/common/read_config.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Attributes: normals, colours and texture coordinates per vertex (NOFF, COFF, STOFF and combinations). Not read:
// colours of faces (a warning); binary OFF, and 4OFF and nOFF of other dimensions.
[[nodiscard]] RawMesh read_off(ByteReader& input, const ReadConfig& config = {});

}  // namespace lodestone
