// The compressed form of a cell's payload: one stream per array, by the codecs of meshoptimizer.
//
//   u32 bytes of each stream, in the order of visit_arrays | stream | stream | ...
//
// Positions are written as integers on the lattice of the whole model, so that a vertex comes out with the same bits in
// every cell; other per-vertex arrays word by word as they are; triangles by the index codec, which keeps their order
// and orientation but may begin each with another corner. Nothing else is lost. How small the streams are depends on
// the order of vertices and triangles (core/hierarchy/build/cell_order.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/lode/lode_payload.h"

namespace lodestone {

// Appends the compressed payload, without padding. Throws InputError when a position is not on the lattice.
void compress_payload(const Cell& cell, Lattice lattice, std::vector<std::byte>& out);

// Writes the arrays to `out` as visit_arrays lists them, without padding; out.size() == plain_bytes(counts). Returns
// what is wrong with the bytes, nullptr when nothing is; whatever they are, nothing outside the two spans is touched.
// Indices may be out of range still: see payload_fault.
[[nodiscard]] const char* decompress_payload(std::span<const std::byte> bytes, const PayloadCounts& counts,
                                             Lattice lattice, std::span<std::byte> out);

// No payload of so many bytes holds more than this many when decompressed: asked before memory is allocated.
[[nodiscard]] constexpr std::uint64_t most_decompressed(std::uint64_t bytes) { return 64 * bytes; }

}  // namespace lodestone
