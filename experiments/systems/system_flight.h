// A camera path as each of several LOD systems draws it, frame by frame, against the full model: what an observer sees
// of levels that change.
#pragma once

#include <functional>
#include <vector>

#include "experiments/metrics/pictures/image_quality.h"
#include "experiments/metrics/pops/image_pops.h"
#include "experiments/systems/system_pictures.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct SystemFlightConfig {
  std::vector<Camera> cameras;
  ViewConfig view;
  std::vector<LodSystem> systems{LodSystem::morph, LodSystem::step, LodSystem::discrete, LodSystem::cross_fade};
  SystemConfig system;
  ImageQualityConfig quality;  // FLIP and SSIM can be left out here; without FLIP there are no pops by FLIP
  ImagePopConfig pops;
  bool geometry = true;  // cracks and jumps of the drawn surface
  bool leaks = true;     // of closed models: asks for geometry
  const CancelFlag* cancel = nullptr;
};

// One frame of one system. Lengths over all models of the scene, in the units of each model; pops and jumps are those
// since the frame before, 0 in the first one.
struct SystemRow {
  std::size_t frame = 0;
  LodSystem system = LodSystem::morph;
  std::uint64_t cells = 0, triangles = 0;  // drawn
  double milliseconds = 0;                 // by the renderer
  int pictures = 1;                        // drawn for this frame
  ImageQuality quality;                    // against the full model
  ImagePops pops;                          // of absolute differences
  ImagePops flip_pops;                     // of FLIP

  std::uint64_t open_edges = 0;  // residual edges
  std::uint64_t gaps = 0;
  double gap_max = 0, gap_mean = 0, gap_max_pixels = 0, gap_mean_pixels = 0;
  std::uint64_t t_junctions = 0;  // border vertices within junction_tolerance of an edge
  bool closed = false;            // all models are: leaks have a meaning
  std::uint64_t leak_pixels = 0, torn_pixels = 0;
  // Of vertices since the frame before. A cross-fade moves none: what it shows is in the pictures alone, and the jumps
  // are left at 0, as they are where the selections cannot be compared.
  double step = 0;  // way of the viewpoint, longest
  double jump_max = 0, jump_p99 = 0, jump_max_pixels = 0, jump_p99_pixels = 0;
  // Of the analytic bound of the morph by the view's own blend, for discrete and step, too; infinite: it has none.
  double jump_over_bound = 0;
};

// Called with each row as it is done, by frame and then in the order of `systems`, with the picture, the one of the
// full model, and the renderer's.
using OnSystemRow = std::function<void(const SystemRow&, const SystemPicture& drawn, const Image& full)>;

// Uploads the scene. The renderer must give pictures with depth: soft or gl. Throws InputError for an empty path or
// list, for `full` among the systems, and what drawing and measuring throw; Cancelled.
[[nodiscard]] std::vector<SystemRow> fly_systems(SceneView& scene, Renderer& renderer, const SystemFlightConfig& config,
                                                 Scheduler& scheduler, const OnSystemRow& on_row = {});

}  // namespace lodestone
