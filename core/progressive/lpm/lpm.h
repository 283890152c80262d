// .lpm: progressive meshes for the wire. A prefix of the file is a coarser mesh.
//
//   "LODELPM1", bytes of the header (32 bits), its CRC-32, the header as JSON,
//   then frames: bytes, CRC-32, vertices of the mesh when it is decoded (32 bits each), and the bytes.
//
// The first frames are the thumbnails of the textures for which the header gives their type. The next one is the base,
// those after it are vertex splits (split_codec.h), each frame range coded for itself with models that go on; the last
// ones are the images, one each, empty where the thumbnail is the image. Little-endian. Everything is quantized:
// positions to 2^position_bits steps over the extent of the model, texture coordinates to 2^uv_bits over their box,
// errors to the upper half of a float, rounded up. The header has a bound of the distance of the finest level from the
// input, quantization included. Normals are not in the file.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone {

class ByteReader;

struct LpmConfig {
  // 4 to 20; 0: 12, or up to 16 until a step is no longer than the error of the level of half the vertices.
  std::uint32_t position_bits = 0;
  std::uint32_t uv_bits = 12;  // 4 to 20
  // Vertices change places within batches, each of this part of the vertices before it (split_order.h), with errors
  // that hold for the new order; 0: none does.
  std::uint32_t batch = 8;
};

struct LpmBytes {
  std::vector<std::byte> bytes;
  std::size_t geometry = 0;  // the part without images and thumbnails
  std::size_t base = 0;      // header, thumbnails and base, which are needed before anything can be drawn
  double finest_error = 0;   // of the mesh that a reader gets: what quantization adds is included
};

// Throws InputError for a mesh whose collapses cannot be undone one by one, which `lodestone progressive` never
// makes. `thumbnails`: those of make_thumbnails(), or empty.
[[nodiscard]] LpmBytes encode_lpm(const ProgressiveMesh& mesh, const LpmConfig& config = {},
                                  std::span<const Texture> thumbnails = {});

// With `prefix`, a file that ends early gives the levels it holds, at least the base, with thumbnails in place of the
// images that have not come, and an estimate as finest_error. Otherwise, and if it is damaged, throws InputError with
// the place; UnsupportedError for a newer version.
[[nodiscard]] ProgressiveMesh read_lpm(ByteReader& input, bool prefix = false);

}  // namespace lodestone
