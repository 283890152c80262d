// Merges view meshes into one mesh.
//
// `concatenate` puts them side by side (the published baseline): where views overlap, so does the mesh. `stitch` keeps
// each piece of the surface from the view that samples it best (ownership.h), zips the seams (seam_mesh.h), fills the
// small holes that are left, and tidies what lies around.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"
#include "render/reconstruct/merge/ownership.h"
#include "render/reconstruct/report/report.h"
#include "render/reconstruct/seams/seam_mesh.h"

namespace lodestone {

struct MergedMesh {
  std::vector<Vec3f> position;  // normalised model space
  std::vector<Vec3f> normal;    // of the surface there, as the maps say
  // The view that saw each vertex; no_view: between samples, made while merging.
  std::vector<ViewNumber> view;
  std::vector<std::uint32_t> pixel;
  std::vector<std::uint8_t> feature;  // already on a sharp edge or corner
  std::vector<Triangle> triangles;
};

struct MergeConfig {
  OwnershipConfig ownership;
  bool closed = false;  // the surface has no border: outlines are holes, too
  // Points on the border of the surface. Empty, and not closed: it may end wherever a view sees it end.
  std::span<const BorderPoint> border{};
  // Separate pieces of fewer triangles are left out; the latter if closed, or beside a larger piece of the same part.
  std::size_t least_piece = 3, least_solid = 20;
  float longest_hole = 48;  // perimeter of holes that are filled, in spacings; of a closed surface all are; 0: none
  std::size_t most_handles = any_number;  // that the result may have
};

// The triangles of all view meshes. Same bytes for any number of workers, as below.
[[nodiscard]] MergedMesh concatenate(std::span<const MergeView> views, Scheduler& scheduler);
// Fills score, owner and kept of the views.
[[nodiscard]] MergedMesh stitch(std::span<MergeView> views, const MergeConfig& config, StitchReport& report,
                                Scheduler& scheduler);

}  // namespace lodestone
