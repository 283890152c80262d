// Assigns each piece of the surface to the view that samples it best.
//
// The score of a pixel is the density of samples around it: the cosine between the surface and the view over the area
// of a pixel. It is nothing at the border of a view mesh and is spread among connected pixels, so that it falls off
// before a silhouette and does not follow every wrinkle; where the surface itself ends it does not fall off, or narrow
// strips would be handed over along seams as ragged as their pixels. The score of a point is then, in every view, a
// function of the point alone, nearly: interpolated in the cell of the view mesh that lies at the point, if one does.
// The owner is the view of the highest score, and all views that see a point agree on it but for a pixel or so along
// the seams. Views are ranked a little besides, so that a plane that two of them see equally well is not torn.
//
// Kernels: rows of one view, no threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/reconstruct/seams/model_border.h"
#include "render/reconstruct/views/view_mesh.h"

namespace lodestone {

struct OwnershipConfig {
  double reference_spacing = 1;            // of samples: distances are judged in this unit; normalised units, > 0
  int spread = 6;                          // rounds of averaging with connected neighbours
  std::span<const std::uint32_t> parts{};  // as in ConnectConfig: no view owns a point of another part
  const ModelBorder* border = nullptr;     // of an open surface, if it is known
};

using ViewNumber = std::uint16_t;
inline constexpr ViewNumber no_view = 0xFFFF;

// A view as the merge sees it.
struct MergeView {
  const PositionMap* map = nullptr;
  const PixelArray<Vec3f>* vertex = nullptr;        // position of each pixel's vertex; null: that of the map
  const PixelArray<std::uint8_t>* links = nullptr;  // on_feature (condense_map.h), or null
  ViewMesh mesh;
  PixelArray<float> score;        // one per pixel; below 0: not to be owned by this view
  PixelArray<ViewNumber> owner;   // one per pixel; no_view where nothing is seen
  PixelArray<std::uint8_t> kept;  // cells of which only the triangles are left that this view owns
};

// Calls visit(i) for the pixels of rows [first, last) of the view that have memory.
template <class Visit>
void for_pixels(const MergeView& view, int first, int last, const Visit& visit) {
  const auto width = static_cast<std::size_t>(view.map->view.width);
  view.map->groups().for_pixels(static_cast<std::size_t>(first) * width, static_cast<std::size_t>(last) * width, visit);
}

// Before spreading, for rows [first, last) of the score.
void score_rows(const MergeView& view, const OwnershipConfig& config, int first, int last, PixelArray<float>& score);
// One round of averaging, from `from` to `to`.
void spread_rows(const MergeView& view, int first, int last, const PixelArray<float>& from, PixelArray<float>& to);

// A view's interpolated score at a point that another map sees; negative if its mesh is not at the point, or its score
// is not above `least`.
[[nodiscard]] float score_at(const MergeView& view, const PositionMap& map, std::size_t pixel,
                             const OwnershipConfig& config, float least = -1);

// Owners of the pixels of rows [first, last) of view `number`.
void own_rows(std::span<MergeView> views, std::size_t number, const OwnershipConfig& config, int first, int last);
// The same after lone pixels were dropped, for pixels whose owner has dropped them.
void own_dropped_rows(std::span<MergeView> views, std::size_t number, const OwnershipConfig& config, int first,
                      int last);
// Triangles whose three corners the view owns.
void keep_rows(MergeView& view, std::size_t number, int first, int last);

// Owned pixels of the rows that are in no triangle of what view `number` keeps get a score of -1: who else sees them
// may have them. Returns how many.
std::size_t drop_lone_rows(MergeView& view, std::size_t number, int first, int last);

}  // namespace lodestone
