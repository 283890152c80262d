// What every fuzz harness of a reader does: any bytes give a mesh that cleaning accepts, or an Error; nothing else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/mesh/clean.h"

namespace lodestone {

inline int fuzz_reader(const std::uint8_t* data, std::size_t size, MeshFormat format) {
  try {
    ByteReader input({reinterpret_cast<const char*>(data), size}, "fuzz");
    const RawMesh raw = read_mesh(input, format);
    // At least a byte was read for every vertex; and a fan of n corners takes n - 2 triangles.
    if (raw.positions.size() > size || raw.triangles.size() > size) std::abort();
    for (const Triangle& t : raw.triangles)
      for (const std::uint32_t id : t.v)
        if (id >= raw.positions.size()) std::abort();
    Repairs repairs;
    const IndexedMesh mesh = clean_mesh(raw, repairs);
    for (const Vec3f p : mesh.positions)
      if (!(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1 && p.z >= 0 && p.z <= 1)) std::abort();
  } catch (const Error&) {
  }
  return 0;
}

}  // namespace lodestone
