// The proof of a frame: cracks and pops of the drawn surface, whole and before culling. The same for every command,
// experiment and system of levels of detail.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "experiments/metrics/cracks/cracks.h"
#include "experiments/metrics/drawn/screen.h"
#include "experiments/metrics/pops/jump_tracker.h"
#include "experiments/subjects/row.h"
#include "parallel/scheduler/scheduler.h"
#include "render/frame/frame.h"

namespace lodestone {

// From one frame to the next. Lengths in percent of the model's extent.
struct JumpSample {
  double largest = 0;
  double pixels = 0;                          // largest in the picture
  std::optional<double> p99{}, p99_pixels{};  // of a thorough proof
  double step = 0;                            // way of the viewpoint
  std::optional<double> per_step{};           // over the way of the viewpoint, where it moves
  std::optional<double> over_bound{};         // of the analytic bound, where there is one
  bool vacuous = false;                       // the way to the parent keeps that bound, too
  double by_limits = 0;                       // by detail limits alone
};

// One frame. Lengths in percent of the model's extent.
struct SurfaceSample {
  std::uint64_t triangles = 0, open_edges = 0;
  double gap = 0, gap_mean = 0;
  double gap_pixels = 0, gap_mean_pixels = 0;
  std::uint64_t gaps = 0, gaps_in_view = 0;                   // numbers, which weigh the means
  std::optional<std::uint64_t> t_junctions{};                 // of a thorough proof
  std::optional<std::uint64_t> torn_pixels{}, leak_pixels{};  // of closed models
  std::optional<JumpSample> jump{};                           // where it follows the frame before
};

// Adds another model of the same frame: counts are summed, lengths are the largest of any.
void add(SurfaceSample& all, const SurfaceSample& model);

// A model as it is drawn.
struct ProofFrame {
  MorphContext morph;
  ViewProjection view_projection{};
  ImageSize size{};
  bool follows = false;   // the frame before is a step away
  bool thorough = true;   // percentiles, T-junctions and leaks, too
  double limit_rate = 0;  // of the detail limits of a streamed hierarchy
  // Measures jumps by the bound of this morph, where what is drawn has none of its own. Null: its own.
  const MorphContext* promise = nullptr;
  // Depth of the full model's picture, in whose silhouette leaks of the background lie; empty: those are not looked
  // for. None: leaks are not measured.
  std::optional<std::span<const float>> full_depth{};
};

class FrameProof {
 public:
  // The hierarchy is the whole one, also where a part of it is drawn; it outlives this.
  FrameProof(const Hierarchy& hierarchy, Scheduler& scheduler);

  [[nodiscard]] SurfaceSample measure(const ProofFrame& frame);
  [[nodiscard]] bool closed() const;  // there are leaks to look for

 private:
  [[nodiscard]] std::optional<JumpSample> follow(const ProofFrame& frame, const MorphContext& morph, Selection whole,
                                                 const Screen& screen);

  const Hierarchy& hierarchy_;
  Scheduler& scheduler_;
  std::shared_ptr<const CrackBasis> basis_;
  CrackScratch scratch_;
  JumpTracker jumps_;
  Vec3f promised_viewpoint_;
  std::optional<Radii> promised_radii_;  // of the frame before
};

// The frames of a flight as columns. Values that no frame has are null.
class SurfaceSummary {
 public:
  void add(const SurfaceSample& sample) { samples_.push_back(sample); }

  [[nodiscard]] static std::vector<ColumnInfo> columns();
  void add_to(Row& row) const;

 private:
  std::vector<SurfaceSample> samples_;
};

}  // namespace lodestone
