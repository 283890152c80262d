// The subject `render`: a camera path through a scene, drawn frame by frame, with the proof of every frame beside its
// cost.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/subjects/frame_proof.h"
#include "experiments/subjects/frame_times.h"
#include "experiments/subjects/row.h"
#include "parallel/scheduler/scheduler.h"
#include "render/camera/camera.h"
#include "render/frame/renderer.h"
#include "render/scene/scene_view.h"

namespace lodestone {

struct RenderJob {
  std::vector<Camera> cameras;
  ViewConfig view;
  bool measure = false;  // cracks and pops of every frame, over the whole partition, before culling
  // The distance on the screen of every frame (metrics/drawn/screen_error.h), each model alone: 100 bytes per triangle,
  // seconds a frame.
  bool measure_screen = false;
  // The models as wholes, to be measured alone; those of the scene where this is empty. For streamed ones.
  std::vector<const Hierarchy*> measured;
  const CancelFlag* cancel = nullptr;
  // Called after each frame has been drawn; read_back() of the renderer gives its picture.
  std::function<void(std::size_t index, Renderer& renderer)> on_frame = [](std::size_t, Renderer&) {};
};

struct FrameResult {
  std::uint64_t cells = 0, triangles = 0;      // drawn, after culling
  std::uint64_t draw_calls = 0;                // of a backend that makes any
  std::map<std::string, double> milliseconds;  // "select", the backend's stages, "total" over all
  StageTime time;
  std::map<std::string, std::uint64_t> work;  // of the effects, as FrameStats has it
  bool drawn = true;                          // false: nothing has changed since the frame before
  std::optional<SurfaceSample> surface;       // of all models, if measured
  std::optional<double> screen_error;         // pixels, the largest of any model, if measured
  std::uint64_t resident_bytes = 0;           // of payloads, of a streamed hierarchy
  bool complete = true;                       // the frame had all the detail that it asked for
};

struct RenderResult {
  bool admissible = true;
  std::vector<FrameResult> frames;
  std::vector<std::string> warnings;  // of the renderer
};

// Uploads the models and draws all frames. Throws Cancelled when job.cancel is set, InputError for an empty path, what
// loading throws.
[[nodiscard]] RenderResult run(const RenderJob& job, SceneView& scene, Renderer& renderer, Scheduler& scheduler);

// The rule for the radii and the metric by their names, and defaults for the rest. Throws InputError for other names.
[[nodiscard]] RadiiConfig radii_config(const std::string& rule, const std::string& metric);

// Columns that the experiments which draw have, too.
[[nodiscard]] std::vector<ColumnInfo> render_columns();
[[nodiscard]] Row to_row(const RenderResult& result);
// The same for one frame; details of stages and streaming are left to the caller.
[[nodiscard]] Row to_row(const FrameResult& frame);

}  // namespace lodestone
