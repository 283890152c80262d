// The pieces of surface that the views keep: what hangs together over edges within one view. Each is a disk with holes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "parallel/scheduler/scheduler.h"
#include "render/reconstruct/merge/ownership.h"

namespace lodestone {

struct ViewPatches {
  std::vector<PixelArray<std::uint32_t>> of_cell;  // of each view's cells; anything where nothing is kept
  std::vector<std::uint32_t> triangles;            // of each patch, how many
};

[[nodiscard]] ViewPatches label_patches(std::span<const MergeView> views, Scheduler& scheduler);

}  // namespace lodestone
