// The neighbours of a vertex, in order around it.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/math/lanes/float8.h"

namespace lodestone::progressive {

using Id = std::uint32_t;
inline constexpr Id no_id = 0xffff'ffffu;

// The triangles of a vertex are (vertex, ids[k], ids[k + 1]), closed rings wrap around. Triangle k is *sector* k. Where
// vertices have wedges, ids[capacity + k] is the wedge of the vertex in sector k.
//
// A cache line with all that most vertices ever have: ids points to `own` until there are more, or wedges. At least
// `readable` ids may be read from there, whatever they are.
struct alignas(64) Ring {
  static constexpr std::uint32_t own_ids = 12, readable = 16;

  Id own[own_ids];
  Id* ids;
  std::uint32_t size;
  std::uint32_t capacity : 31, open : 1;

  Ring() {}  // nothing is set: fresh memory is touched by the code that fills it
  Ring(const Ring& other) { *this = other; }
  Ring& operator=(const Ring& other) {
    for (std::uint32_t k = 0; k < own_ids; ++k) own[k] = other.own[k];
    ids = other.ids == other.own ? own : other.ids;
    size = other.size, capacity = other.capacity, open = other.open;
    return *this;
  }

  // No neighbours yet, and a place for a few.
  void clear() { ids = own, size = 0, capacity = own_ids, open = 0; }
  [[nodiscard]] std::uint32_t next(std::uint32_t k) const { return k + 1 < size ? k + 1 : 0; }
  [[nodiscard]] std::uint32_t previous(std::uint32_t k) const { return k > 0 ? k - 1 : size - 1; }
  [[nodiscard]] std::uint32_t sectors() const { return size - open; }
  // The size, if there is no such neighbour. Eight at a time, since its place cannot be predicted; thirty-two of a hub
  // of thousands.
  [[nodiscard]] std::uint32_t find(Id id) const {
    const Int8 wanted = ints8(static_cast<std::int32_t>(id));
    const auto are = [&](std::uint32_t k) { return bits(load<Int8>(ids + k) == wanted); };
    std::uint32_t k = 0;
    do {
      if (const unsigned found = are(k); found != 0)
        return std::min(k + static_cast<std::uint32_t>(std::countr_zero(found)), size);
      k += 8;
      while (k + 32 <= size && (are(k) | are(k + 8) | are(k + 16) | are(k + 24)) == 0) k += 32;
    } while (k < size);
    return size;
  }
  [[nodiscard]] Id& wedge(std::uint32_t k) const { return ids[capacity + k]; }
  [[nodiscard]] std::span<const Id> neighbours() const { return {ids, size}; }
};
static_assert(sizeof(Ring) == 64);

// Memory for rings that outgrow their place. One per worker at a time; given back with the mesh.
class RingArena {
 public:
  // `readable` ids after them may be read, too.
  [[nodiscard]] Id* take(std::size_t count);

 private:
  std::vector<std::unique_ptr<Id[]>> chunks_;
  Id* next_ = nullptr;
  std::size_t left_ = 0;
};

}  // namespace lodestone::progressive
