#include "core/hierarchy/lode/lode_payload.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "core/base/error.h"

namespace lodestone {
namespace {

using StreamSizes = std::array<std::uint32_t, payload_arrays>;

// The formats are fixed rather than left to the defaults of the installed library, so that equal hierarchies give equal
// bytes. The library stores them in globals.
void choose_formats() {
  static const bool chosen = [] {
    meshopt_encodeVertexVersion(0);
    meshopt_encodeIndexVersion(1);
    return true;
  }();
  (void)chosen;
}

// Appends elements of `bytes` bytes by the vertex codec of meshoptimizer.
void encode_words(const void* items, std::size_t count, std::size_t bytes, std::vector<std::byte>& out) {
  const std::size_t before = out.size(), bound = meshopt_encodeVertexBufferBound(count, bytes);
  out.resize(before + bound);
  const std::size_t written =
      meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data() + before), bound, items, count, bytes);
  assert(written > 0);
  out.resize(before + written);
}

template <class T>
void encode(std::span<const T> items, Lattice, std::vector<std::byte>& out) {
  static_assert(sizeof(T) % 4 == 0 && sizeof(T) <= 256);
  encode_words(items.data(), items.size(), sizeof(T), out);
}

struct LatticePoint {
  std::uint32_t x = 0, y = 0, z = 0;
};
static_assert(sizeof(LatticePoint) == sizeof(Vec3f));  // decoded in place

void encode(std::span<const Vec3f> positions, Lattice lattice, std::vector<std::byte>& out) {
  std::vector<LatticePoint> points(positions.size());
  const auto n = static_cast<float>(lattice.last());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3f p = positions[i];
    if (!lattice || !lattice.holds(p))
      throw InputError(describe("", "", "a vertex is not on the lattice", "build the hierarchy on one"));
    points[i] = {static_cast<std::uint32_t>(p.x * n), static_cast<std::uint32_t>(p.y * n),
                 static_cast<std::uint32_t>(p.z * n)};
  }
  encode_words(points.data(), points.size(), sizeof(LatticePoint), out);
}

void encode(std::span<const Triangle> triangles, Lattice, std::vector<std::byte>& out) {
  const std::size_t count = 3 * triangles.size(), before = out.size();
  std::uint32_t largest = 0;
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t.v) largest = std::max(largest, v);
  const std::size_t bound = meshopt_encodeIndexBufferBound(count, std::size_t{largest} + 1);
  out.resize(before + bound);
  const std::size_t written = meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(out.data() + before), bound,
                                                        triangles.data()->v.data(), count);
  assert(written > 0);
  out.resize(before + written);
}

template <class T>
void encode(const IndexView<T>& items, Lattice lattice, std::vector<std::byte>& out) {
  std::vector<T> room;
  encode(items.widened(room), lattice, out);
}

// Each returns true if the stream has exactly `count` elements.
bool decode_words(std::span<const std::byte> stream, std::byte* to, std::size_t count, std::size_t bytes) {
  return meshopt_decodeVertexBuffer(to, count, bytes, reinterpret_cast<const unsigned char*>(stream.data()),
                                    stream.size()) == 0;
}

template <class T>
struct Decode {
  static bool run(std::span<const std::byte> stream, std::byte* to, std::size_t count, Lattice) {
    return decode_words(stream, to, count, sizeof(T));
  }
};

template <>
struct Decode<Vec3f> {
  static bool run(std::span<const std::byte> stream, std::byte* to, std::size_t count, Lattice lattice) {
    if (!decode_words(stream, to, count, sizeof(LatticePoint))) return false;
    const std::uint32_t last = lattice.last();
    const float step = lattice.step();
    std::uint32_t outside = 0;
    for (std::size_t i = 0; i < 3 * count; ++i) {  // coordinate by coordinate: vectorized
      std::uint32_t v = 0;
      std::memcpy(&v, to + 4 * i, 4);
      outside |= v > last ? 1u : 0u;
      const float coordinate = static_cast<float>(static_cast<std::int32_t>(v)) * step;
      std::memcpy(to + 4 * i, &coordinate, 4);
    }
    return outside == 0;
  }
};

template <>
struct Decode<Triangle> {
  static bool run(std::span<const std::byte> stream, std::byte* to, std::size_t count, Lattice) {
    return meshopt_decodeIndexBuffer(to, 3 * count, sizeof(std::uint32_t),
                                     reinterpret_cast<const unsigned char*>(stream.data()), stream.size()) == 0;
  }
};

}  // namespace

void compress_payload(const Cell& cell, Lattice lattice, std::vector<std::byte>& out) {
  choose_formats();
  const std::size_t start = out.size();
  StreamSizes sizes{};
  out.resize(start + sizeof(sizes));
  std::size_t array = 0;
  PayloadCounts counts = counts_of(cell);
  counts.short_indices = false;
  visit_arrays(cell, counts, [&](const auto& items, std::size_t) {
    const std::size_t before = out.size();
    if (!items.empty()) encode(items, lattice, out);
    sizes[array++] = static_cast<std::uint32_t>(out.size() - before);
  });
  std::memcpy(out.data() + start, sizes.data(), sizeof(sizes));
}

const char* decompress_payload(std::span<const std::byte> bytes, const PayloadCounts& counts, Lattice lattice,
                               std::span<std::byte> out) {
  assert(out.size() == plain_bytes(counts) && !counts.short_indices);
  StreamSizes sizes{};
  if (bytes.size() < sizeof(sizes)) return "the payload ends inside its table of sizes";
  std::memcpy(sizes.data(), bytes.data(), sizeof(sizes));
  bytes = bytes.subspan(sizeof(sizes));
  std::byte* to = out.data();
  std::size_t array = 0;
  const char* fault = nullptr;
  const Cell types;
  visit_arrays(types, counts, [&]<class Array>(const Array&, std::size_t count) {
    using T = std::remove_cvref_t<decltype(Array().front())>;
    const std::uint32_t size = sizes[array++];
    if (fault) return;
    if (size > bytes.size()) {
      fault = "a stream goes beyond the payload";
    } else if (count == 0 ? size != 0 : !Decode<T>::run(bytes.first(size), to, count, lattice)) {
      fault = "a stream is invalid";
    } else {
      bytes = bytes.subspan(size);
      to += count * sizeof(T);
    }
  });
  return fault;
}

}  // namespace lodestone
