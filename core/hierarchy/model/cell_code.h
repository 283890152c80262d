// Cells of the cubic grids: integer coordinates, Morton order.
//
// The cell of grid 0 is the unit cube; a cell of grid g has side 2^-g. Cells are half-open, [i, i+1) 2^-g; what lies on
// a far face of the cube belongs to the last cell.
#pragma once

#include <cstdint>

#include "core/math/vec3.h"

namespace lodestone {

inline constexpr int max_level = 15;

struct CellCoord {
  std::uint16_t x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const CellCoord&, const CellCoord&) = default;
};

// Side length of the cells of a grid.
[[nodiscard]] constexpr float cell_size(int grid) { return 1.0f / static_cast<float>(1u << grid); }

// Spreads the low 16 bits of v to every third bit.
[[nodiscard]] constexpr std::uint64_t spread3(std::uint64_t v) {
  v &= 0xffff;
  v = (v | (v << 16)) & 0x0000'0000'ff00'00ffull;
  v = (v | (v << 8)) & 0x0000'00f0'0f00'f00full;
  v = (v | (v << 4)) & 0x0000'0c30'c30c'30c3ull;
  v = (v | (v << 2)) & 0x0000'2492'4924'9249ull;
  return v;
}

[[nodiscard]] constexpr std::uint16_t compact3(std::uint64_t v) {
  v &= 0x0000'2492'4924'9249ull;
  v = (v | (v >> 2)) & 0x0000'0c30'c30c'30c3ull;
  v = (v | (v >> 4)) & 0x0000'00f0'0f00'f00full;
  v = (v | (v >> 8)) & 0x0000'0000'ff00'00ffull;
  v = (v | (v >> 16)) & 0xffffull;
  return static_cast<std::uint16_t>(v);
}

// A cell of a given grid by its Morton code: the bits of x, y, z interleaved, x lowest. That of the next
// coarser grid is code >> 3.
struct CellCode {
  std::uint64_t morton = 0;

  [[nodiscard]] static constexpr CellCode from(CellCoord c) {
    return {spread3(c.x) | (spread3(c.y) << 1) | (spread3(c.z) << 2)};
  }
  [[nodiscard]] constexpr CellCoord coord() const {
    return {compact3(morton), compact3(morton >> 1), compact3(morton >> 2)};
  }
  [[nodiscard]] constexpr CellCode parent() const { return {morton >> 3}; }
  friend constexpr auto operator<=>(const CellCode&, const CellCode&) = default;
};

// Which grid the levels of a hierarchy lie in: level l in grid l. With half levels two levels share each grid but that
// of the root, of which the coarser has the same cells and half of the triangles.
struct LevelGrids {
  bool halves = false;

  [[nodiscard]] constexpr int of(int level) const { return halves ? (level + 1) / 2 : level; }
  // The level of the whole grid, both of whose levels are in the hierarchy; at most max_level.
  [[nodiscard]] constexpr int finest_level(int grid) const {
    const int level = halves ? 2 * grid : grid;
    return level < max_level ? level : max_level;
  }
  // True if the cells of the level and their parents are the same.
  [[nodiscard]] constexpr bool keeps_cells(int level) const { return halves && level > 0 && level % 2 == 0; }
  [[nodiscard]] constexpr CellCode parent(CellCode cell, int level) const {
    return keeps_cells(level) ? cell : cell.parent();
  }
  friend constexpr bool operator==(const LevelGrids&, const LevelGrids&) = default;
};

// The barycentre in the arithmetic that decides the partition: float, in this order. Verifiers use it too, since the
// cell of a triangle is a matter of definition, not of accuracy.
[[nodiscard]] constexpr Vec3f barycentre(Vec3f a, Vec3f b, Vec3f c) {
  constexpr float third = 1.0f / 3.0f;
  return {((a.x + b.x) + c.x) * third, ((a.y + b.y) + c.y) * third, ((a.z + b.z) + c.z) * third};
}

// Cell of a point of the unit cube.
[[nodiscard]] constexpr CellCoord cell_of(Vec3f p, int grid) {
  const auto n = static_cast<float>(1u << grid);
  const auto last = static_cast<std::uint32_t>((1u << grid) - 1);
  const auto slot = [&](float v) {
    const float scaled = v * n;
    if (!(scaled > 0)) return std::uint16_t{0};
    const auto i = static_cast<std::uint32_t>(scaled);
    return static_cast<std::uint16_t>(i < last ? i : last);
  };
  return {slot(p.x), slot(p.y), slot(p.z)};
}

}  // namespace lodestone
