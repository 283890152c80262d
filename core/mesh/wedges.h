// Turns attributes given corner by corner into wedges that corners share.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/attributes.h"

namespace lodestone {

inline constexpr std::uint32_t no_value = 0xFFFF'FFFFu;
inline constexpr Triangle no_values{{no_value, no_value, no_value}};

// Tables of values, and for each corner of each triangle the index of its value, or no_value.
struct CornerAttributes {
  std::vector<Vec2f> uv;
  std::vector<Vec3f> normal;
  std::vector<Triangle> uv_of, normal_of;  // one per triangle; empty: the attribute is absent
  std::vector<Rgba8> colour;               // one per vertex, or empty
};

// Corners of one vertex with equal values share a wedge, whatever indices the file gives them: exporters that repeat
// the values of every corner do not split the surface. Values are equal when their bits are; -0 counts as +0.
// Wedges are in the order of their vertices; an unused vertex has none. Memory besides the result: 24 bytes per
// triangle and 16 per vertex.
[[nodiscard]] RawWedges make_wedges(std::span<const Triangle> triangles, std::size_t vertex_count,
                                    const CornerAttributes& attributes);

}  // namespace lodestone
