// Pops in the image: what an observer sees change that a model at full detail would not have changed.
//
// E_t is the error of the picture at time t against that of the full model, by pixel: absolute difference or FLIP. A
// pixel of frame t sees a point of the full model, whose depth is known; the cameras of both frames say exactly where
// the point was in frame t - 1. Where it was seen there, too, pop_t = |E_t - E_{t-1}(where it was)|: an error that
// stays where it is, however large, is not a pop.
//
// E_{t-1} is interpolated between the (up to four) pixels around that place that see the same surface: depth within a
// tolerance of the one expected. Pixels without any have no predecessor: they were hidden or outside of the picture.
// They are left out and counted. Of the background the direction counts as its point: it moves as the sky does.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "experiments/metrics/pictures/error_map.h"
#include "parallel/scheduler/scheduler.h"
#include "render/camera/camera.h"

namespace lodestone {

// One frame: its error maps (by different measures, the same ones in both frames), and the picture of the full model by
// the same camera, with depth. What is drawn does not move between two frames, so that the matrix may be that of any
// one of its models, the same in both.
struct ErrorFrame {
  std::vector<const ErrorMap*> errors;
  const Image* full = nullptr;
  ViewProjection view_projection;
};

struct ImagePopConfig {
  double threshold = visible_change;  // a pixel that changes by more has popped
  double depth_tolerance = 0.01;      // relative, of clip w; in (0, 1)
  // 0: as above. From 1 to 8: pop_t is how far E_t lies outside of the range of E_{t-1} within so many pixels of the
  // place it comes from. Errors of unfiltered pictures are noise from pixel to pixel, and noise that a camera carries
  // along looks like pops; what no neighbour had before does not.
  int neighbourhood = 0;
};

struct ImagePops {
  double p50 = 0, p99 = 0, max = 0, mean = 0;  // of pop_t over the pixels with a predecessor
  double changed_share = 0;                    // of these pixels, those above the threshold
  std::uint64_t changed = 0;                   // their number
  std::uint64_t largest_changed = 0;           // pixels of the largest connected part of them (8 neighbours)
  std::uint64_t pixels = 0;                    // with a predecessor
  std::uint64_t without_predecessor = 0;
};

// Instead of the change of a pixel without a predecessor.
inline constexpr float no_predecessor = std::numeric_limits<float>::infinity();

// For each error map by pixel of frame `now`: pop_t with its sign, or no_predecessor. Throws InputError when there is
// no map or not the same number, when a picture has no depth, when sizes are not the same, when a matrix cannot be
// inverted, or when the configuration is out of range. The same bytes for any number of workers.
[[nodiscard]] std::vector<std::vector<float>> change_maps(const ErrorFrame& before, const ErrorFrame& now,
                                                          Scheduler& scheduler, const ImagePopConfig& config = {});

// One such map of a picture, whatever the sign; pixels that change by more than the threshold have popped.
[[nodiscard]] ImagePops summarise_pops(std::span<const float> changes, ImageSize size, double threshold);

// Size of the largest set of pixels above the threshold that hang together by sides or corners.
[[nodiscard]] std::uint64_t largest_connected_area(std::span<const float> values, ImageSize size, double threshold);

}  // namespace lodestone
