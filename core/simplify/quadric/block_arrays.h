// The working memory of the quadric kernel: one block of at most 61,440 vertices, 16-bit ids, about 190 bytes a vertex.
//
// There is no triangle list and no half-edge structure: each vertex keeps the ordered ring of its neighbours, and the
// rings are the mesh. A ring is 32 bytes, so that one 256-bit load brings the whole star.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "core/math/lanes/aligned_point.h"
#include "core/math/quadric.h"
#include "core/simplify/contract/simplifier.h"

namespace lodestone::quadric {

using Id = std::uint16_t;

// Ids from here on are not vertices. A lane of a ring that is not a neighbour can therefore never match an id.
inline constexpr Id id_limit = 0xf000;
inline constexpr Id none = 0xffff;
inline constexpr std::size_t id_space = 0x1'0000;  // arrays cover every 16-bit value: no load needs a mask

inline constexpr unsigned ring_capacity = 14;  // vertices of higher degree are never collapsed into being
inline constexpr unsigned flags_lane = 15;

// Bits of the last lane of a ring.
enum Flags : Id {
  flags_base = id_limit,
  movable = 1,      // not locked, and a ring holds its neighbours: may collapse, and be relocated if it is one fan
  open = 2,         // one open fan: the first and the last of the ring are its neighbours on the border of the surface
  locked = 4,       // locked by the caller
  nonmanifold = 8,  // several fans or worse: the ring is an unordered set of the neighbours (nonmanifold_stars.h)
  crowded = 16,     // more neighbours than a ring holds: the ring is empty, and nothing collapses into the vertex
  queued = 32,      // waits in a bucket
  gone = 64,        // collapsed; its ring is undefined
  seamed = 128,     // at the end of a seam between wedges
  sealed = 256      // its wedges have no order, or are too many: it does not collapse, and nothing collapses into it
};

struct alignas(32) Ring {
  Id lane[16];  // neighbours counter-clockwise, `none` up to lane 14, then Flags
  [[nodiscard]] bool has(Flags f) const { return (lane[flags_lane] & f) != 0; }
};

// The quadric of a vertex, centred there.
struct alignas(64) Body : CentredQuadric {
  float reach;  // no member is farther from the vertex; never too small
};

// The vertices that have collapsed into a vertex are its members, a list that begins with the vertex itself.
struct Member {
  Id next, tail;  // the member after this one; the end of the list, for a vertex that survives
};
static_assert(sizeof(Ring) == 32 && sizeof(AlignedPoint) == 16 && sizeof(Body) == 64);

// The edges of the link of a vertex, one per triangle, until the ring is known.
struct alignas(64) Link {
  struct Edge {
    Id from, to;
  } edge[16];
};

// Float exponent and four bits of the mantissa: a sixteenth more than the bucket below.
inline constexpr int bucket_shift = 19;
inline constexpr std::size_t bucket_count = 1u << (31 - bucket_shift);
inline constexpr unsigned nowhere = bucket_count;  // a bucket that is never emptied

struct Arrays {
  Ring in_front;  // a load of shifted lanes may begin before the first ring
  Ring ring[id_space];
  AlignedPoint point[id_space];  // coordinates of the input times a power of two
  Body body[id_space];
  Member member[id_space];
  Link link[id_space];
  std::uint32_t triangles[id_space];  // at each vertex
  Id next_in_bucket[id_space];
  Id bucket[bucket_count + 1];
};

struct FreeArrays {
  void* memory;  // from the allocator, in front of the aligned arrays
  void operator()(Arrays*) const { std::free(memory); }
};
// Zeroed; pages are touched only as far as blocks reach.
[[nodiscard]] std::unique_ptr<Arrays, FreeArrays> allocate_arrays();

class NonmanifoldStars;
class Seams;

// The working memory of a block beside its arrays; without seams where the input has no wedges.
struct BlockMemory {
  Arrays& arrays;
  NonmanifoldStars& nonmanifold;
  Seams* seams;
};

// Simplifies a block of at most id_limit vertices; `result` has its final sizes. Every build gives the same bytes. The
// builds for AVX2 and AVX-512 are null where the compiler does not know them.
using BlockKernel = void (*)(const SimplifyInput& input, Placement placement, const BlockMemory& memory,
                             SimplifyResult& result);
extern const BlockKernel plain_kernel, avx2_kernel, avx512_kernel;

}  // namespace lodestone::quadric
