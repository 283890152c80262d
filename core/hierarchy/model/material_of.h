// The material of a triangle: an attribute of its wedges, the same for all three.
#pragma once

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// Index into Hierarchy::materials, or no_material; `corner` is any corner of the triangle.
[[nodiscard]] inline std::uint32_t material_of(const Hierarchy& hierarchy, const Cell& cell, std::uint32_t corner) {
  if (hierarchy.attributes.materials) return cell.attributes.materials[corner];
  return hierarchy.materials.empty() ? no_material : 0;
}

}  // namespace lodestone
