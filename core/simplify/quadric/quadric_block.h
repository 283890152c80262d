// The working memory of the quadric kernel: one block of at most 61,440 vertices, 16-bit ids, about 190 bytes a vertex.
//
// There is no triangle list and no half-edge structure: each vertex keeps the ordered ring of its neighbours, and the
// rings are the mesh. A ring is 32 bytes, so that one 256-bit load brings the whole star.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "core/simplify/block/simplifier.h"

namespace lodestone::quadric {

using Id = std::uint16_t;

// Ids from here on are no vertices. A lane of a ring that is not a neighbour can therefore never match an id.
inline constexpr Id id_limit = 0xf000;
inline constexpr Id none = 0xffff;
inline constexpr std::size_t id_space = 0x1'0000;  // arrays cover every 16-bit value: no load needs a mask

inline constexpr unsigned ring_capacity = 14;  // vertices of higher degree are never collapsed into being
inline constexpr unsigned flags_lane = 15;

// Bits of the last lane of a ring.
enum Flags : Id {
  flags_base = id_limit,
  movable = 1,   // not locked, and a ring holds its neighbours: may collapse, and be relocated where it is one fan
  open = 2,      // one open fan: the first and the last of the ring are its neighbours on the border of the surface
  locked = 4,    // locked by the caller
  pile = 8,      // several fans or not manifold: the ring is an unordered set of the neighbours (quadric_piles.h)
  bare = 16,     // more neighbours than a ring holds: the ring is empty, and nothing collapses into it
  queued = 32,   // waits in a bucket
  gone = 64,     // collapsed; its ring means nothing any more
  seamed = 128,  // at the end of a seam between wedges
  sealed = 256   // of wedges without order, or too many: neither goes nor is arrived at
};

struct alignas(32) Ring {
  Id lane[16];  // neighbours counter-clockwise, `none` up to lane 14, then Flags
  [[nodiscard]] bool has(Flags f) const { return (lane[flags_lane] & f) != 0; }
};

// Coordinates are those of the input times a power of two. Four floats: one load.
struct alignas(16) Point {
  float x, y, z, unused;
};

// Quadric relative to the vertex itself: with the origin there, sums lose nothing to cancellation and a fresh quadric
// has neither a linear term nor an error.
struct alignas(64) Body {
  float xx, xy, xz, yy, yz, zz;
  float weight;  // sum of areas
  float error;   // value at the vertex
  float bx, by, bz;
  float reach;  // no member is farther from the vertex; never too small
};

// Where the list of the members goes on, and, for a vertex that survives, where it ends.
struct Member {
  Id next, tail;
};
static_assert(sizeof(Ring) == 32 && sizeof(Point) == 16 && sizeof(Body) == 64);

// The edges of a vertex's link, one per triangle, until the ring is known.
struct alignas(64) Link {
  struct Edge {
    Id from, to;
  } edge[16];
};

// Float exponent and four bits of the mantissa: a sixteenth more than the bucket below.
inline constexpr int bucket_shift = 19;
inline constexpr std::size_t bucket_count = 1u << (31 - bucket_shift);
inline constexpr unsigned nowhere = bucket_count;  // a bucket that nobody empties

struct Arrays {
  Ring in_front;  // a load of shifted lanes may begin before the first ring
  Ring ring[id_space];
  Point point[id_space];
  Body body[id_space];
  Member member[id_space];
  Link link[id_space];
  std::uint32_t triangles[id_space];  // of each vertex
  Id next_in_bucket[id_space];
  Id bucket[bucket_count + 1];
};

struct FreeArrays {
  void* memory;  // what the allocator gave, in front of the aligned arrays
  void operator()(Arrays*) const { std::free(memory); }
};
// Zeroed; pages are touched only as far as blocks reach.
[[nodiscard]] std::unique_ptr<Arrays, FreeArrays> allocate_arrays();

class Piles;
class Seams;

// The two builds of the same kernel: equal bytes. At most id_limit vertices; `result` has its final sizes. piles,
// seams: working memory, for wedges null where the input has none.
void simplify_block_plain(const SimplifyInput& input, Placement placement, Arrays& arrays, Piles& piles, Seams* seams,
                          SimplifyResult& result);
void simplify_block_avx2(const SimplifyInput& input, Placement placement, Arrays& arrays, Piles& piles, Seams* seams,
                         SimplifyResult& result);

}  // namespace lodestone::quadric
