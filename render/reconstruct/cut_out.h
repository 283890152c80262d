// The surface beside the borders of what views keep, taken out of the merged mesh, and put back when it is sewn.
#pragma once

#include <span>

#include "render/reconstruct/gather.h"
#include "render/reconstruct/label_patches.h"
#include "render/reconstruct/seam_mesh.h"

namespace lodestone {

// Takes the triangles beside borders; vertex k of the seam is gathered.far + k of the merged mesh. `parts`: of the
// model's triangles, or empty.
[[nodiscard]] SeamMesh cut_out_seams(std::span<const MergeView> views, std::span<const std::uint32_t> parts,
                                     const PixelFlags& flags, const Patches& patches, Gathered& gathered,
                                     Scheduler& scheduler);
// Puts them back: triangles behind those that are there, vertices that are still used behind the frozen ones.
void put_back(const SeamMesh& seam, Gathered& gathered);

}  // namespace lodestone
