// The two halves of a reconstruction: maps drawn here or read from files (map_files.h), and a mesh from maps.
#pragma once

#include <optional>

#include "render/position_map/map_files.h"
#include "render/reconstruct/merge/merge.h"
#include "render/reconstruct/reconstruct.h"

namespace lodestone {

struct DrawnMaps {
  std::vector<PositionMap> maps;
  double spacing = 0;                           // of their samples, normalised units; 0: that of the report
  std::vector<PixelArray<std::uint8_t>> links;  // of each map, as ConnectConfig has them; or empty
  std::vector<PixelArray<Vec3f>> vertices;      // of each map, as MergeView has them; or empty
  bool closed = false;
  bool oriented = true;                   // neighbouring triangles agree on the outside
  std::size_t most_handles = any_number;  // that the surface may have
  std::vector<std::uint32_t> parts;       // of the triangles; empty: one
  std::vector<BorderPoint> border;        // where the surface ends; empty: nowhere, or not known
};

// Views of one mesh: those that were chosen last serve again where the same choice is asked for, as it is at most
// resolutions of one search.
class LastChoice {
 public:
  const ChosenViews& views(const IndexedMesh& mesh, const ViewChoice& choice, Scheduler& scheduler);

 private:
  std::optional<ViewChoice> choice_;
  ChosenViews chosen_;
};
[[nodiscard]] DrawnMaps draw_maps(const IndexedMesh& mesh, const ReconstructConfig& config, LastChoice& last,
                                  ReconstructReport& report, Scheduler& scheduler);
// Maps that were read; the report gets their spacing.
[[nodiscard]] DrawnMaps drawn_maps(MapSet&& set, ReconstructReport& report);
// `mesh`: the mesh that the maps show, for its attributes; null: not known. The maps are given up: their views and
// transforms remain.
[[nodiscard]] RawMesh mesh_from_maps(DrawnMaps& drawn, const IndexedMesh* mesh, const ReconstructConfig& config,
                                     ReconstructReport& report, Scheduler& scheduler);
// One after the other.
[[nodiscard]] Reconstruction reconstruct(const IndexedMesh& mesh, const ReconstructConfig& config, LastChoice& last,
                                         Scheduler& scheduler);

}  // namespace lodestone
