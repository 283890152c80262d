// Fixtures of the tests of the crack metrics: a hierarchy with its basis, whole levels as frames, fast beside slow
// form.
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "experiments/metrics/cracks/adversary.h"
#include "experiments/metrics/cracks/crack_basis.h"
#include "experiments/metrics/cracks/cracks.h"
#include "tests/experiments/lod_frames.h"
#include "tests/experiments/naive_hierarchy.h"
#include "tests/experiments/naive_metrics.h"
#include "tests/experiments/small_meshes.h"

namespace lodestone::testing {

inline constexpr int finest = 4;
inline constexpr float sigma0 = 0.6f;

// A hierarchy with all that measuring its frames takes.
struct Subject {
  explicit Subject(const IndexedMesh& mesh, int levels = finest) : built(naive_hierarchy(mesh, levels, sigma0)) {
    rebuild_basis();
  }
  void rebuild_basis() { basis = make_crack_basis(built.hierarchy, *scheduler); }
  [[nodiscard]] const Hierarchy& hierarchy() const { return built.hierarchy; }

  CrackReport cracks(const Frame& frame) {
    return residual_edges(frame.context, frame.selection, *basis, *scheduler, scratch);
  }
  GapReport gaps(const Frame& frame) {
    return vertex_gaps(frame.context, frame.selection, *basis, *scheduler, scratch);
  }

  NaiveHierarchy built;
  std::unique_ptr<Scheduler> scheduler = make_serial_scheduler();
  std::shared_ptr<const CrackBasis> basis;
  CrackScratch scratch;
};

// Residual edges of frames that morph for viewpoints delta h_L nearer and farther than those they were selected for.
inline std::uint64_t open_edges_when_stale(Subject& subject, const Radii& radii, std::size_t views, float delta) {
  std::uint64_t open = 0;
  for (const AdversarialView& view : adversarial_views(subject.hierarchy(), radii, {.count = views})) {
    Frame frame = make_frame(subject.hierarchy(), radii, Blend::linear, view.viewpoint);
    const Vec3f away = view.viewpoint - subject.hierarchy().cells[view.cell].positions[view.vertex];
    for (const float side : {-0.999f, 0.999f}) {
      frame.context.viewpoint = view.viewpoint + side * delta * cell_size(finest) / length(away) * away;
      open += subject.cracks(frame).open_edges;
    }
  }
  return open;
}

inline void expect_twins_agree(Subject& subject, const Frame& frame) {
  const CrackReport cracks = subject.cracks(frame);
  const GapReport gaps = subject.gaps(frame);
  const GapReport slow_gaps = naive_vertex_gaps(frame.context, frame.selection);
  EXPECT_EQ(cracks.open_edges, naive_residual_edges(frame.context, frame.selection));
  EXPECT_EQ(gaps.gaps, slow_gaps.gaps);
  EXPECT_EQ(gaps.gap_max, slow_gaps.gap_max);
  EXPECT_NEAR(gaps.gap_mean, slow_gaps.gap_mean, 1e-12);
  EXPECT_EQ(cracks.open_edges == 0, cracks.samples.empty());
}

// A frame that draws exactly the cells of one level, where lambda = `lambda_one` ? 1 : 0.
struct LevelFrame {
  Radii radii;
  Frame frame;
};

inline LevelFrame draw_level(const Hierarchy& hierarchy, int level, bool lambda_one) {
  LevelFrame drawn;
  const std::size_t count = hierarchy.levels.size();
  drawn.radii.select.assign(count, 0);
  drawn.radii.band_begin.assign(count, lambda_one ? 1e9f : 0.0f);
  drawn.radii.band_end.assign(count, lambda_one ? 2e9f : 1e-9f);
  drawn.radii.band_begin[0] = drawn.radii.band_end[0] = std::numeric_limits<float>::infinity();
  drawn.frame.context = {&hierarchy, nullptr, Blend::linear, {9, 9, 9}};
  const Level& l = hierarchy.levels[static_cast<std::size_t>(level)];
  for (CellId c = l.first_cell; c < l.end_cell(); ++c)
    drawn.frame.selection.cells.push_back({c, static_cast<std::uint8_t>(level)});
  return drawn;
}

inline std::uint64_t open_edges_of_level(Subject& subject, int level, bool lambda_one) {
  LevelFrame drawn = draw_level(subject.hierarchy(), level, lambda_one);
  drawn.frame.context.radii = &drawn.radii;
  expect_twins_agree(subject, drawn.frame);
  return subject.cracks(drawn.frame).open_edges;
}

}  // namespace lodestone::testing
