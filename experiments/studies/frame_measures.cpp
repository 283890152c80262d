#include "experiments/studies/frame_measures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "experiments/metrics/cracks/leaks.h"
#include "experiments/metrics/cracks/t_junctions.h"
#include "experiments/metrics/pictures/flip.h"

namespace lodestone {
namespace {

// Black, red, yellow, white.
Image heat_map(const ErrorMap& map) {
  Image image{map.size, {}, {}};
  for (const float value : map.value)
    for (const float channel : {3 * value, 3 * value - 1, 3 * value - 2, 1.0f})
      image.rgba.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(channel, 0.0f, 1.0f))));
  return image;
}

// Lengths in percent of the model's size.
JumpSample sample_of(const PopReport& jumps) {
  JumpSample sample{100 * jumps.max_jump, 100 * jumps.p99_jump, jumps.max_jump_pixels, jumps.p99_jump_pixels, {}, {}};
  if (jumps.step > 0) sample.per_step = jumps.max_jump / jumps.step;
  if (jumps.bounded) sample.over_bound = jumps.jump_over_bound;
  return sample;
}

}  // namespace

SurfaceMeasures::SurfaceMeasures(const Hierarchy& hierarchy, ImageSize size, Scheduler& scheduler)
    : hierarchy_(hierarchy), size_(size), scheduler_(scheduler), basis_(make_crack_basis(hierarchy, scheduler)) {
  if (basis_.unpaired.empty()) full_.emplace(hierarchy, at_full_detail(view_of_model(size, 1)), "soft", scheduler);
}

SurfaceSample SurfaceMeasures::measure(const ModelFrame& frame, const Shot& shot) {
  const MorphContext& morph = frame.morph;
  const Screen screen(frame.view_projection, size_);
  Selection whole;
  select_cells(hierarchy_, *morph.radii, morph.viewpoint, {}, whole);
  SurfaceSample sample;
  for (const SelectedCell& s : whole.cells)
    sample.triangles += static_cast<double>(hierarchy_.cells[s.cell].triangles.size());

  sample.open_edges = static_cast<double>(residual_edges(morph, whole, basis_, scheduler_, scratch_).open_edges);
  const GapReport gaps = vertex_gaps(morph, whole, basis_, scheduler_, scratch_, &screen);
  sample.gap = 100 * gaps.gap_max, sample.gap_mean = 100 * gaps.gap_mean, sample.gap_pixels = gaps.gap_max_pixels;
  sample.gap_mean_pixels = gaps.gap_mean_pixels;
  const double near = junction_tolerance * cell_size(hierarchy_.finest());
  sample.t_junctions = static_cast<double>(t_junctions(morph, whole, near, scheduler_).vertices);
  if (full_) {
    full_->draw(shot.camera);
    const Image full = full_->renderer().read_back();
    const LeakReport leaks = find_leaks(morph, whole, screen, scheduler_, {.full_depth = full.depth});
    sample.torn_pixels = static_cast<double>(leaks.torn);
    sample.leak_pixels = static_cast<double>(leaks.leak_pixels());
  }
  if (!shot.follows) jumps_.forget();
  const auto jumps = jumps_.follow(morph, std::move(whole), scheduler_, {.percentiles = true, .screen = &screen});
  if (jumps) sample.jump = sample_of(*jumps);
  return sample;
}

PictureSample PictureMeasures::measure(const Image& picture, Image full, const ViewProjection& view_projection,
                                       bool follows) {
  Frame now{std::move(full), {}, {}, view_projection};
  now.absolute = absolute_error(now.full, picture);
  now.flip = flip_error(now.full, picture, scheduler_);
  PictureSample sample;
  ImageQualityConfig config;
  config.with_flip = false;
  sample.quality = image_quality(now.full, picture, scheduler_, config);
  sample.quality.flip = summarise(now.flip.value);
  if (follows && previous_) {
    const auto errors = [](const Frame& frame) {
      return ErrorFrame{{&frame.absolute, &frame.flip}, &frame.full, frame.view_projection};
    };
    const std::vector<ImagePops> pops = image_pops(errors(*previous_), errors(now), scheduler_);
    sample.pops = pops[0], sample.flip_pops = pops[1];
  }
  previous_ = std::move(now);
  return sample;
}

void WorstPicture::offer(const Image& picture, const Image& full, double flip) {
  if (flip <= flip_) return;
  flip_ = flip, picture_ = picture, full_ = full;
}

void WorstPicture::write(const std::string& directory, Scheduler& scheduler) const {
  if (flip_ < 0) return;
  write_png(directory + "/worst-drawn.png", picture_);
  write_png(directory + "/worst-full.png", full_);
  write_png(directory + "/worst-flip.png", heat_map(flip_error(full_, picture_, scheduler)));
}

}  // namespace lodestone
