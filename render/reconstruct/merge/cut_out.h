// Takes the surface near the borders of the views' pieces out of the merged mesh, and puts it back when it is sewn.
#pragma once

#include <span>

#include "render/reconstruct/merge/gather.h"
#include "render/reconstruct/merge/label_patches.h"
#include "render/reconstruct/seams/seam_mesh.h"

namespace lodestone {

// Takes the triangles beside borders; vertex k of the seam is gathered.far + k of the merged mesh. `parts`: of the
// model's triangles, or empty.
[[nodiscard]] SeamMesh cut_out_seams(std::span<const MergeView> views, std::span<const std::uint32_t> parts,
                                     const PixelFlags& flags, const ViewPatches& patches, Gathered& gathered,
                                     Scheduler& scheduler);
// Puts them back: triangles after the existing ones, vertices that are still used after the frozen ones.
void put_back(const SeamMesh& seam, Gathered& gathered);

}  // namespace lodestone
