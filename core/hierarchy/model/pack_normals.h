// Packing many normals at once, in lanes.
#pragma once

#include <span>

#include "core/hierarchy/model/hierarchy.h"
#include "core/math/lanes/float4.h"

namespace lodestone {

// The bits of pack_normal for each; packed has at least the length of n.
void pack_normals(std::span<const Float4> n, std::span<PackedNormal> packed);

}  // namespace lodestone
