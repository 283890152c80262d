// Attributes of survivors that have moved.
#pragma once

#include <span>

#include "core/hierarchy/construct/block_wedges.h"
#include "core/mesh/attributes.h"

namespace lodestone {

// The attributes of the wedges of a block; each is empty where there are none.
struct MovedAttributes {
  std::span<const BlockWedges::Moved> moved;
  std::span<const Triangle> triangles;  // by wedge
  std::span<Vec2f> uv;
  std::span<Rgba8> colours;
};

// Gives survivors that have moved the attributes of their new place, from the triangles as they were.
void interpolate_attributes(const MovedAttributes& attributes);

}  // namespace lodestone
