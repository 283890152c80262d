// A camera path as each of several LOD systems draws it, frame by frame, against the full model: what an observer sees
// of levels that change.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/metrics/pictures/image_quality.h"
#include "experiments/metrics/pops/picture_pops.h"
#include "experiments/subjects/frame_proof.h"
#include "experiments/systems/system_pictures.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct SystemFlightConfig {
  std::vector<Camera> cameras;
  ViewConfig view;
  std::vector<std::string> systems{"morph", "step", "discrete", "cross-fade"};
  SystemConfig system;
  ImageQualityConfig quality;  // FLIP and SSIM can be left out here; without FLIP there are no pops by FLIP
  ImagePopConfig pops;
  bool geometry = true;  // cracks and jumps of the drawn surface
  bool leaks = true;     // of closed models: asks for geometry
  bool screen = false;   // distances on the screen
  const CancelFlag* cancel = nullptr;
};

// One frame of one system.
struct SystemRow {
  std::size_t frame = 0;
  std::string system;
  std::uint64_t cells = 0, triangles = 0;  // drawn
  double milliseconds = 0;                 // by the renderer
  int pictures = 1;                        // drawn for this frame
  ImageQuality quality;                    // against the full model
  std::optional<PicturePops> pops{};       // since the frame before
  // Cracks and jumps over all models, if measured. A cross-fade moves no vertex: its changes are in the pictures alone,
  // and there are no jumps. The bound of jumps is that of the morph by the view's own blend, for discrete and step,
  // too.
  std::optional<SurfaceSample> surface;
  // Distances on the screen between the drawn and the full surface, and between the drawn surface and that of the frame
  // before, both as the camera of this frame sees them; the largest of all models.
  std::optional<double> screen_error{}, shift_pixels{};
};

// Called with each row as it is done, by frame and then in the order of `systems`, with the picture, the one of the
// full model, and the renderer's.
using OnSystemRow = std::function<void(const SystemRow&, const SystemPicture& drawn, const Image& full)>;

// Uploads the scene. The renderer must give pictures with depth: soft or gl. Throws InputError for an empty path or
// list, for `full` among the systems, and what drawing and measuring throw; Cancelled.
[[nodiscard]] std::vector<SystemRow> fly_systems(SceneView& scene, Renderer& renderer, const SystemFlightConfig& config,
                                                 Scheduler& scheduler, const OnSystemRow& on_row = {});

}  // namespace lodestone
