// One model before a camera, as the experiments draw it.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/studies/experiment.h"
#include "experiments/studies/viewpoints.h"
#include "experiments/subjects/frame_times.h"
#include "parallel/scheduler/scheduler.h"
#include "render/frame/renderer.h"
#include "render/scene/scene_view.h"

namespace lodestone {

// As a scene of one model asks for.
[[nodiscard]] ViewConfig view_of_model(ImageSize size, int samples);
// The same, drawn from M_L alone.
[[nodiscard]] ViewConfig at_full_detail(ViewConfig config);

class ModelDrawer {
 public:
  // Hierarchy and scheduler outlive it. Throws what make_renderer throws.
  ModelDrawer(const Hierarchy& hierarchy, const ViewConfig& config, std::string_view backend, Scheduler& scheduler);

  struct Drawn {
    FrameStats stats;
    StageTime time;
    double select_seconds = 0;  // of that: radii and selection
  };
  Drawn draw(const Camera& camera);

  [[nodiscard]] const SceneView& view() const { return view_; }
  [[nodiscard]] Renderer& renderer() { return *renderer_; }

 private:
  ViewConfig config_;
  SceneView view_;
  std::unique_ptr<Renderer> renderer_;
};

// All shots once to warm up, then `rounds` times. There is at least one.
[[nodiscard]] FlightTimes time_flight(ModelDrawer& drawer, std::span<const Shot> shots, int rounds,
                                      const RunContext& context);

}  // namespace lodestone
