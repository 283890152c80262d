#include "experiments/subjects/frame_proof.h"

#include <algorithm>

#include "experiments/metrics/cracks/crack_basis.h"
#include "experiments/metrics/cracks/leaks.h"
#include "experiments/metrics/cracks/t_junctions.h"
#include "experiments/metrics/drawn/screen.h"
#include "experiments/metrics/pops/pops.h"
#include "render/lod/selection.h"

namespace lodestone {
namespace {

JumpSample sample_of(const PopReport& jumps, bool thorough) {
  JumpSample sample{.largest = 100 * jumps.max_jump,
                    .pixels = jumps.max_jump_pixels,
                    .step = 100 * jumps.step,
                    .by_limits = 100 * jumps.max_limit_jump};
  if (thorough) sample.p99 = 100 * jumps.p99_jump, sample.p99_pixels = jumps.p99_jump_pixels;
  if (jumps.step > 0) sample.per_step = jumps.max_jump / jumps.step;
  if (jumps.bounded) sample.over_bound = jumps.jump_over_bound, sample.vacuous = jumps.vacuous;
  return sample;
}

void raise(double& to, double value) { to = std::max(to, value); }

void raise(std::optional<double>& to, const std::optional<double>& value) {
  if (value) to = std::max(to.value_or(*value), *value);
}

template <class Value>
void raise(Row& cell, const Value& value) {
  if (cell.is_null() || cell.get<Value>() < value) cell = value;
}

template <class Value>
void raise(Row& cell, const std::optional<Value>& value) {
  if (value) raise(cell, *value);
}

void increase(std::optional<std::uint64_t>& to, const std::optional<std::uint64_t>& value) {
  if (value) to = to.value_or(0) + *value;
}

double weighted_mean(double a, std::uint64_t number_a, double b, std::uint64_t number_b) {
  const auto weight_a = static_cast<double>(number_a), weight_b = static_cast<double>(number_b);
  return weight_a + weight_b > 0 ? (a * weight_a + b * weight_b) / (weight_a + weight_b) : 0;
}

void add_jumps(std::optional<JumpSample>& all, const std::optional<JumpSample>& model) {
  if (!model) return;
  if (!all) {
    all = model;
    return;
  }
  raise(all->largest, model->largest), raise(all->p99, model->p99), raise(all->by_limits, model->by_limits);
  raise(all->pixels, model->pixels), raise(all->p99_pixels, model->p99_pixels);
  raise(all->per_step, model->per_step), raise(all->step, model->step);
  all->vacuous = all->vacuous || model->vacuous;
  if (!model->over_bound) all->over_bound.reset();  // no bound for one model is none for all
  if (all->over_bound) raise(all->over_bound, model->over_bound);
}

}  // namespace

using enum ColumnInfo::Kind;

void add(SurfaceSample& all, const SurfaceSample& model) {
  all.gap_mean = weighted_mean(all.gap_mean, all.gaps, model.gap_mean, model.gaps);
  all.gap_mean_pixels = weighted_mean(all.gap_mean_pixels, all.gaps_in_view, model.gap_mean_pixels, model.gaps_in_view);
  all.triangles += model.triangles, all.open_edges += model.open_edges;
  all.gaps += model.gaps, all.gaps_in_view += model.gaps_in_view;
  raise(all.gap, model.gap), raise(all.gap_pixels, model.gap_pixels);
  increase(all.t_junctions, model.t_junctions);
  increase(all.torn_pixels, model.torn_pixels), increase(all.leak_pixels, model.leak_pixels);
  add_jumps(all.jump, model.jump);
}

FrameProof::FrameProof(const Hierarchy& hierarchy, Scheduler& scheduler)
    : hierarchy_(hierarchy), scheduler_(scheduler), basis_(make_crack_basis(hierarchy, scheduler)) {}

bool FrameProof::closed() const { return basis_->unpaired.empty(); }

SurfaceSample FrameProof::measure(const ProofFrame& frame) {
  MorphContext morph = frame.morph;
  morph.hierarchy = &hierarchy_;
  const Screen screen(frame.view_projection, frame.size);
  Selection whole;
  select_cells(hierarchy_, *morph.radii, morph.viewpoint, {.limits = morph.limits}, whole);
  SurfaceSample sample;
  for (const SelectedCell& s : whole.cells) sample.triangles += hierarchy_.cells[s.cell].triangles.size();

  sample.open_edges = residual_edges(morph, whole, *basis_, scheduler_, scratch_).open_edges;
  const GapReport gaps = vertex_gaps(morph, whole, *basis_, scheduler_, scratch_, &screen);
  sample.gap = 100 * gaps.gap_max, sample.gap_mean = 100 * gaps.gap_mean;
  sample.gap_pixels = gaps.gap_max_pixels, sample.gap_mean_pixels = gaps.gap_mean_pixels;
  sample.gaps = gaps.gaps, sample.gaps_in_view = gaps.gaps_in_view;
  if (frame.thorough) {
    const double near = junction_tolerance * hierarchy_.cell_size(hierarchy_.finest());
    sample.t_junctions = t_junctions(morph, whole, near, scheduler_).vertices;
  }
  if (frame.full_depth && closed()) {
    const LeakReport leaks = find_leaks(morph, whole, screen, scheduler_, {.full_depth = *frame.full_depth});
    sample.torn_pixels = leaks.torn, sample.leak_pixels = leaks.leak_pixels();
  }
  sample.jump = follow(frame, morph, std::move(whole), screen);
  return sample;
}

std::optional<JumpSample> FrameProof::follow(const ProofFrame& frame, const MorphContext& morph, Selection whole,
                                             const Screen& screen) {
  if (!frame.follows) {
    jumps_.forget();
    promised_radii_.reset();
  }
  std::vector<double> bounds;
  if (frame.promise) {
    MorphContext before = *frame.promise;
    if (promised_radii_) before.radii = &*promised_radii_, before.viewpoint = promised_viewpoint_;
    bounds = jump_bounds(before, *frame.promise);
    promised_radii_ = *frame.promise->radii, promised_viewpoint_ = frame.promise->viewpoint;
  }
  const auto jumps = jumps_.follow(
      morph, std::move(whole), scheduler_,
      {.limit_rate = frame.limit_rate, .percentiles = frame.thorough, .screen = &screen, .bounds = bounds});
  return jumps ? std::optional(sample_of(*jumps, frame.thorough)) : std::nullopt;
}

std::vector<ColumnInfo> SurfaceSummary::columns() {
  const std::string percent = "% of the extent";
  return {
      {"surface_triangles", "", "triangles of the whole surface as drawn, before culling, mean over the frames", cost},
      {"open_edges", "", "residual edges of a frame, by the exact definition, maximum", accuracy},
      {"cracked_frames", "%", "frames with residual edges", accuracy},
      {"gap_max", percent, "largest distance of two places at which one vertex is drawn", accuracy},
      {"gap_mean", percent, "mean of these distances where there are any, of the worst frame", accuracy},
      {"gap_pixels", "pixels", "largest distance of two places at which one vertex is drawn", accuracy},
      {"gap_mean_pixels", "pixels", "mean of these distances where there are any in view, of the worst frame",
       accuracy},
      {"t_junctions", "",
       "border vertices nearer to the inside of another border edge than 1 % of a finest cell's side, maximum",
       accuracy},
      {"torn_pixels", "pixels", "rays through a crack of a closed model, hidden or not, maximum", accuracy},
      {"leak_pixels", "pixels", "where a closed model shows its inside or what is behind it, maximum", accuracy},
      {"jump_pixels", "pixels", "largest way of a vertex in the picture, without the camera's own", accuracy},
      {"viewpoint_step", percent, "largest way of the viewpoint from one frame to the next", accuracy},
      {"jump_max", percent, "largest way of a vertex from one frame to the next", accuracy},
      {"jump_p99", percent, "way that 99 % of the vertices do not exceed, maximum", accuracy},
      {"jump_per_step", "", "largest way of a vertex over that of the viewpoint", accuracy},
      {"jump_p99_pixels", "pixels", "way that 99 % of the vertices in view do not exceed, maximum", accuracy},
      {"jump_over_bound", "",
       "largest jump over the analytic bound of the morph (of blend = step: of a linear one); above 1: a pop; null: "
       "there is no bound",
       accuracy},
      {"vacuous_frames", "%",
       "frames whose steps are so long that this bound reaches from a vertex to its parent: it tells nothing there",
       accuracy},
  };
}

void SurfaceSummary::add_to(Row& row) const {
  const auto count = static_cast<double>(std::max<std::size_t>(samples_.size(), 1));
  std::uint64_t triangles = 0, cracked = 0;
  for (const SurfaceSample& s : samples_) triangles += s.triangles, cracked += s.open_edges > 0 ? 1 : 0;
  row["surface_triangles"] = static_cast<double>(triangles) / count;
  row["cracked_frames"] = 100 * static_cast<double>(cracked) / count;

  // Each the largest of all frames; null where no frame has it.
  for (const ColumnInfo& column : columns())
    if (!row.contains(column.name)) row[column.name] = nullptr;
  bool bounded = true;
  std::size_t followed = 0, vacuous = 0;
  for (const SurfaceSample& s : samples_) {
    raise(row["open_edges"], s.open_edges), raise(row["t_junctions"], s.t_junctions);
    raise(row["gap_max"], s.gap), raise(row["gap_mean"], s.gap_mean), raise(row["gap_pixels"], s.gap_pixels);
    raise(row["gap_mean_pixels"], s.gap_mean_pixels);
    raise(row["torn_pixels"], s.torn_pixels), raise(row["leak_pixels"], s.leak_pixels);
    if (!s.jump) continue;
    raise(row["jump_max"], s.jump->largest), raise(row["jump_p99"], s.jump->p99);
    raise(row["jump_per_step"], s.jump->per_step);
    raise(row["jump_pixels"], s.jump->pixels), raise(row["jump_p99_pixels"], s.jump->p99_pixels);
    raise(row["jump_over_bound"], s.jump->over_bound);
    raise(row["viewpoint_step"], s.jump->step);
    bounded = bounded && s.jump->over_bound;
    ++followed, vacuous += s.jump->vacuous ? 1 : 0;
  }
  if (followed > 0) row["vacuous_frames"] = 100 * static_cast<double>(vacuous) / static_cast<double>(followed);
  if (!bounded) row["jump_over_bound"] = row["vacuous_frames"] = nullptr;
}

}  // namespace lodestone
