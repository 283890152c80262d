// Runs of a cell's triangles that are out of the picture, or of a shadow map: a cell at its border is not drawn as a
// whole.
//
// A run is 128 triangles in the stored order. Its box holds their corners at both ends of the morph, and so at any
// lambda. Runs are left out only if no pixel of the picture can be touched (screen_box), or if they lie before the near
// plane as clearly as culled cells do: no bit of a picture changes. Runs that others hide: render/culling/occlusion.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "render/camera/camera.h"
#include "render/lod/selection.h"

namespace lodestone {

class CullingRuns {
 public:
  static constexpr std::uint32_t length = 128;  // triangles; the last run of a cell may be shorter

  // Gives every visible cell at the border of the picture the runs that are in it: an empty range if none is. They lie
  // in `ranges`, which are replaced.
  void cull(const Hierarchy& hierarchy, const ViewProjection& view_projection, ImageSize size, Selection& selection,
            std::vector<TriangleRange>& ranges);

  // Boxes of the cell's runs, rounded outwards as far as blending may round. They are found when they are first asked
  // for: O(triangles).
  [[nodiscard]] std::span<const Box3f> boxes(const Hierarchy& hierarchy, CellId cell);
  // The children of a cell are no longer in memory.
  void forget(const Hierarchy& hierarchy, CellId parent);

 private:
  std::vector<std::vector<Box3f>> boxes_;  // by cell
};

}  // namespace lodestone
