#include "core/hierarchy/construct/compact_order.h"

#include <array>
#include <utility>

namespace lodestone {
namespace {

constexpr int bits = 3;                   // of the coordinates of a box
constexpr std::int32_t side = 1 << bits;  // boxes of a cell on each axis
constexpr std::uint32_t boxes = 1u << 3 * bits;

// Gray code of the box, turned and mirrored bit by bit as the curve is within each octant.
constexpr std::uint16_t hilbert(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::array<std::uint32_t, 3> c{x, y, z};
  for (std::uint32_t bit = side / 2; bit > 1; bit /= 2)
    for (std::uint32_t& axis : c) {
      const std::uint32_t low = bit - 1, swapped = axis & bit ? low : (c[0] ^ axis) & low;
      if (!(axis & bit)) axis ^= swapped;
      c[0] ^= swapped;
    }
  c[1] ^= c[0];
  c[2] ^= c[1];
  std::uint32_t turned = 0;
  for (std::uint32_t bit = side / 2; bit > 1; bit /= 2)
    if (c[2] & bit) turned ^= bit - 1;
  for (std::uint32_t& axis : c) axis ^= turned;
  return static_cast<std::uint16_t>(spread3(c[2]) | spread3(c[1]) << 1 | spread3(c[0]) << 2);
}

constexpr std::size_t index_of(std::int32_t x, std::int32_t y, std::int32_t z) {
  return static_cast<std::size_t>((x << bits | y) << bits | z);
}

constexpr auto places = [] {
  std::array<std::uint16_t, boxes> result{};
  for (std::int32_t x = 0; x < side; ++x)
    for (std::int32_t y = 0; y < side; ++y)
      for (std::int32_t z = 0; z < side; ++z)
        result[index_of(x, y, z)] =
            hilbert(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(z));
  return result;
}();

}  // namespace

std::uint16_t curve_place(CellCoord box) { return places[index_of(box.x, box.y, box.z)]; }

void sort_compactly(std::span<const Triangle> triangles, std::span<const Float4> positions, CellCode code, int level,
                    std::span<Triangle> sorted, CompactOrderScratch& scratch) {
  scratch.resize(triangles.size());
  const CellCoord cell = code.coord();
  const Float4 first = to_float4(Vec3f{1.0f * side * cell.x, 1.0f * side * cell.y, 1.0f * side * cell.z}),
               last = all4(side - 1);
  const Float4 per_box = all4(1.0f / 3.0f * static_cast<float>(1u << (level + bits)));
  std::array<std::uint32_t, boxes> next{};  // by place: first how many triangles, then where the next one goes
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& v = triangles[t].v;
    const Float4 sum = (positions[v[0]] + positions[v[1]]) + positions[v[2]];
    const Int4 box = __builtin_convertvector(min(max(sum * per_box - first, Float4{}), last), Int4);
    ++next[scratch[t] = places[index_of(box[0], box[1], box[2])]];
  }
  std::uint32_t end = 0;
  for (std::uint32_t& n : next) end += std::exchange(n, end);
  for (std::size_t t = 0; t < triangles.size(); ++t) sorted[next[scratch[t]]++] = triangles[t];
}

}  // namespace lodestone
