// Readers of one format each, the MeshFormat LODESTONE_FORMAT: any bytes give a mesh that cleaning accepts, or an
// Error.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/formats/mesh_reader.h"
#include "core/mesh/clean.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  try {
    ByteReader input({reinterpret_cast<const char*>(data), size}, "fuzz");
    const RawMesh raw = read_mesh(input, MeshFormat::LODESTONE_FORMAT);
    // Every vertex takes at least a byte of the input; and a fan of n corners makes n - 2 triangles.
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
