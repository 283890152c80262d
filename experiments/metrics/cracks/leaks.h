// Leaks: pixels in which a closed model can be seen through.
//
// Along the ray through a pixel's centre, triangles that show their face count +1 and those that show their back -1,
// all of them, hidden or not. The sum over a closed surface is 0 for an eye outside of it, whatever the surface does,
// if coverage is decided exactly: vertices are snapped to 1/256 pixel and edges have a top-left rule, so that two
// triangles with a common edge share no pixel and miss none. A sum other than 0 is a ray through a crack, in a layer
// that is seen or in one that is hidden. From an eye within the surface the sum is -1 (the winding number tells), and
// backs are visible: they are not leaks then.
//
// An observer sees a back face where the ray is torn, or the background well inside the silhouette. Which
// side is the outside follows from the sign of the volume.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "experiments/metrics/drawn/screen.h"
#include "parallel/scheduler/scheduler.h"
#include "render/lod/morph.h"
#include "render/lod/selection.h"

namespace lodestone {

struct LeakConfig {
  // Window depth of the picture of the full model by the same camera (Image::depth), for its silhouette; empty: the
  // background is not looked at. It must outlive the call.
  std::span<const float> full_depth;
  // Pixels by which the silhouettes of the two may differ, at least 0: background counts where all pixels within this
  // distance (along x and y) belong to the full model.
  int silhouette_tolerance = 2;
};

struct LeakReport {
  std::uint64_t torn = 0;        // pixels whose sum is not 0
  std::uint64_t back_faces = 0;  // torn pixels whose nearest triangle shows its back
  // Pixels without any triangle inside the silhouette of the full model: those that hang together, by sides or corners,
  // with a torn one are seen through two cracks; the others are where the outline differs by more than the tolerance,
  // as it does beside a gap in the model that is narrower than a pixel.
  std::uint64_t background = 0, outline = 0;
  std::uint64_t folded = 0;   // the nearest triangle shows its back, but nothing is torn: the surface folds there
  std::uint64_t covered = 0;  // pixels with a triangle
  std::uint64_t inside = 0;   // pixels inside the full silhouette by more than the tolerance; 0 without full_depth
  std::vector<std::uint8_t> leaks;  // by pixel, rows from the top: 1 where a back face or the background leaks
  [[nodiscard]] std::uint64_t leak_pixels() const { return back_faces + background; }
};

// The oriented triangles of a closed model, all of them, in the space of the screen. Throws InputError when full_depth
// has another number of pixels. The same bytes for any number of workers. Time: triangles + covered pixels, every
// layer.
[[nodiscard]] LeakReport find_leaks(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                                    const Screen& screen, Scheduler& scheduler, const LeakConfig& config = {});

// Leaks of a drawn frame: the whole partition, whether culled or not (keep_culled = true).
[[nodiscard]] LeakReport find_leaks(const MorphContext& context, const Selection& selection, const Screen& screen,
                                    Scheduler& scheduler, const LeakConfig& config = {});

}  // namespace lodestone
