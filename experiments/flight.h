// A flight: a camera path over one hierarchy, drawn frame by frame, with the proof of every frame beside its cost.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "parallel/scheduler.h"
#include "render/camera.h"
#include "render/lod/radii.h"
#include "render/lod/resident_cells.h"
#include "render/renderer.h"

namespace lodestone {

struct FlightConfig {
  std::vector<Camera> cameras;
  ImageSize size;
  int samples = 1;    // a pixel, as in Frame
  RadiiConfig radii;  // image height, field of view and aspect are taken from size and each camera
  Blend blend = Blend::smoothstep;
  bool tint_by_level = false;
  bool measure = false;  // cracks and pops of every frame, over the whole partition, before culling
  // Draws what is there of a streamed hierarchy, updated before every frame; see fly().
  ResidentCells* resident = nullptr;
  const CancelFlag* cancel = nullptr;
};

struct FrameRow {
  std::uint64_t cells = 0, triangles = 0;      // drawn, after culling
  std::uint64_t selected_triangles = 0;        // of the whole partition; only when measured
  std::map<std::string, double> milliseconds;  // "select", "stream", the backend's stages, "total" over all
  std::uint64_t open_edges = 0;                // residual edges of the exact definition; must be 0
  double gap_max = 0;                          // normalised units
  double max_jump = 0;                         // against the frame before, normalised units
  double jump_over_bound = 0;                  // largest jump over its analytic bound
  std::uint64_t resident_bytes = 0;            // of payloads, of a streamed hierarchy
  bool complete = true;                        // the frame had all the detail that it asked for
};

struct FlightResult {
  bool admissible = false;
  std::vector<FrameRow> frames;
  std::uint64_t open_edges_max = 0;
  double gap_max = 0, jump_over_bound_max = 0, milliseconds_median = 0;
};

// Called after each frame has been drawn; read_back() of the renderer gives its picture.
using OnFrame = std::function<void(std::size_t index, Renderer& renderer)>;

// Uploads the hierarchy and draws all frames; with config.resident that one is drawn, and `hierarchy`, the same file as
// a whole, is there to be measured alone (or not looked at, then it may be resident->hierarchy() itself). Throws
// Cancelled when config.cancel is set, InputError for an empty path, what loading throws.
[[nodiscard]] FlightResult fly(const Hierarchy& hierarchy, Renderer& renderer, const FlightConfig& config,
                               Scheduler& scheduler, const OnFrame& on_frame = {});

}  // namespace lodestone
