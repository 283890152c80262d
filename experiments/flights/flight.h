// A flight: a camera path through a scene, drawn frame by frame, with the proof of every frame beside its cost.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "parallel/scheduler/scheduler.h"
#include "render/camera/camera.h"
#include "render/frame/renderer.h"
#include "render/scene/scene_view.h"

namespace lodestone {

struct FlightConfig {
  std::vector<Camera> cameras;
  ViewConfig view;
  bool measure = false;  // cracks and pops of every frame, over the whole partition, before culling
  // The distance on the screen of every frame (metrics/screen_error.h), each model alone: 100 bytes per triangle,
  // seconds a frame.
  bool measure_screen = false;
  // The models as wholes, to be measured alone; those of the scene where this is empty. For streamed ones.
  std::vector<const Hierarchy*> measured;
  const CancelFlag* cancel = nullptr;
};

struct FrameRow {
  std::uint64_t cells = 0, triangles = 0;      // drawn, after culling
  std::uint64_t draw_calls = 0;                // of a backend that makes any
  std::uint64_t selected_triangles = 0;        // of the whole partition; only when measured
  std::map<std::string, double> milliseconds;  // "select", the backend's stages, "total" over all
  std::map<std::string, std::uint64_t> work;   // of the effects, as FrameStats has it
  bool drawn = true;                           // false: nothing has changed since the frame before
  std::uint64_t open_edges = 0;                // residual edges of the exact definition; must be 0
  double gap_max = 0;                          // normalised units of the model
  double max_jump = 0;                         // against the frame before, normalised units
  double jump_over_bound = 0;                  // largest jump over its analytic bound
  double screen_error = 0;                     // pixels, the largest of any model; only when measured
  std::uint64_t resident_bytes = 0;            // of payloads, of a streamed hierarchy
  bool complete = true;                        // the frame had all the detail that it asked for
};

struct FlightResult {
  bool admissible = false;
  std::vector<FrameRow> frames;
  std::uint64_t open_edges_max = 0;
  double gap_max = 0, jump_over_bound_max = 0, screen_error_max = 0, milliseconds_median = 0;
  std::vector<std::string> warnings;  // of the renderer
};

// Called after each frame has been drawn; read_back() of the renderer gives its picture.
using OnFrame = std::function<void(std::size_t index, Renderer& renderer)>;

// Uploads the models and draws all frames. Cracks are summed over the models, jumps are the largest of any. Throws
// Cancelled when config.cancel is set, InputError for an empty path, what loading throws.
[[nodiscard]] FlightResult fly(SceneView& scene, Renderer& renderer, const FlightConfig& config, Scheduler& scheduler,
                               const OnFrame& on_frame = {});

}  // namespace lodestone
