// Bare heights: any format and any bytes give a grid whose every triangle has its corners, or an Error. SRTM tiles are
// such grids of two sizes.
#include <cstdint>
#include <cstdlib>

#include "core/base/error.h"
#include "core/files/scalar.h"
#include "core/formats/mesh_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  if (size < 4) return 0;
  constexpr ScalarType types[] = {ScalarType::int16, ScalarType::uint8, ScalarType::float32, ScalarType::float64};
  ReadConfig config;
  config.fill_voids = (data[0] & 1) != 0;
  config.raw_grid = {.width = 2u + data[1] % 30u,
                     .height = 2,
                     .type = types[data[0] / 2 % 4],
                     .byte_order = data[0] & 8 ? std::endian::big : std::endian::little,
                     .spacing = data[3] + 0.5};
  RawGridFormat& grid = *config.raw_grid;
  const std::size_t bytes = size - 4, row = grid.width * size_of(grid.type);
  if ((data[0] & 16) == 0) grid.height = std::max<std::size_t>(2, bytes / row);
  const std::size_t used = (data[0] & 32) == 0 ? std::min(bytes, grid.height * row) : bytes;
  for (const MeshFormat format : {MeshFormat::raw_grid, MeshFormat::hgt}) {
    try {
      ByteReader input({reinterpret_cast<const char*>(data) + 4, used}, data[2] & 1 ? "N49W124.hgt" : "fuzz");
      const RawMesh mesh = read_mesh(input, format, config);
      if (mesh.triangles.size() > 2 * used) std::abort();
      for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t id : t.v)
          if (id >= mesh.positions.size()) std::abort();
    } catch (const Error&) {
    }
  }
  return 0;
}
