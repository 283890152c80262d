// LOD meshes from position maps: draw a model from several views, connect neighbouring pixels, merge the views.
// docs/decisions/0020 says where this follows Deng et al. and where not.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"
#include "render/position_map/map_view.h"
#include "render/reconstruct/report/report.h"

namespace lodestone {

struct PositionMap;  // render/position_map/position_map.h

// shell: what is visible from outside, as one closed surface (outside/shell.h); it needs neither view choice nor parts.
enum class MergeKind : std::uint8_t { concatenate, stitch, shell };

struct ReconstructConfig {
  double resolution =
      256;  // pixels along the longest side of the bounding box; the spacing of the samples is its inverse
  MergeKind merge = MergeKind::stitch;
  // Maps are drawn by this factor finer than `resolution`, and the stitched mesh is simplified to as many triangles as
  // the resolution gives (simplify_merged.h): 1 to 16; 1: not. Narrow strips are drawn finer still (reconstruct.cpp).
  double detail = 2;
  std::uint64_t triangles = 0;  // simplify to so many instead, where the maps give more; 0: not
  Projection projection = Projection::orthographic;
  std::string backend = "soft";
  ViewChoice views = {};
  float max_slope = 8;         // depth over width, see ConnectConfig
  float slack = 1;             // pixel spacings, likewise
  bool condense = true;        // draw maps of twice the resolution and condense them (condense_map.h)
  bool extend = false;         // boundaries to the silhouette
  bool separate_parts = true;  // never connect parts of the mesh that share no vertex, where they are large enough
  bool lost_parts = true;      // take over parts too small for the maps (lost_parts.h), if the mesh is known
  float longest_hole = 48;     // spacings, of the maps where the surface is open; see MergeConfig
  float sharp_degrees = 35;    // of the angle across a sharp feature that is recovered after stitching; 0: none
  bool attributes = false;     // texture coordinates, colours, normals, materials
  bool keep_maps = false;      // in the result
};

struct Reconstruction {
  RawMesh mesh;  // in the space of the model
  ReconstructReport report;
  std::shared_ptr<const std::vector<PositionMap>> maps;  // where they were to be kept
};

// Throws InputError for a config out of range. A model of which nothing is seen gives a mesh without triangles.
[[nodiscard]] Reconstruction reconstruct(const IndexedMesh& mesh, const ReconstructConfig& config,
                                         Scheduler& scheduler);

// Reconstructs about this number of triangles: the resolution follows from the area, or from trials if nothing is
// simplified.
[[nodiscard]] Reconstruction reconstruct_to_triangles(const IndexedMesh& mesh, ReconstructConfig config,
                                                      std::uint64_t triangles, Scheduler& scheduler);

// One sample per pixel of a screen of `rows` rows and a vertical field of view of 45 degrees, seen from `distance` in
// model units.
[[nodiscard]] double resolution_at_distance(const IndexedMesh& mesh, double distance, int rows = 1080);

}  // namespace lodestone
