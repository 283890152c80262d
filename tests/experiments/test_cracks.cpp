#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "experiments/metrics/adversary.h"
#include "experiments/metrics/cracks.h"
#include "tests/experiments/lod_frames.h"
#include "tests/experiments/naive_hierarchy.h"
#include "tests/experiments/naive_metrics.h"
#include "tests/experiments/small_meshes.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr int finest = 4;
constexpr float sigma0 = 0.6f;

// A hierarchy with all that measuring its frames takes.
struct Subject {
  explicit Subject(const IndexedMesh& mesh, int levels = finest) : built(naive_hierarchy(mesh, levels, sigma0)) {
    rebuild_basis();
  }
  void rebuild_basis() { basis = make_crack_basis(built.hierarchy, *scheduler); }
  [[nodiscard]] const Hierarchy& hierarchy() const { return built.hierarchy; }

  CrackReport cracks(const Frame& frame) {
    return residual_edges(frame.context, frame.selection, basis, *scheduler, scratch);
  }
  GapReport gaps(const Frame& frame) { return vertex_gaps(frame.context, frame.selection, basis, *scheduler, scratch); }

  NaiveHierarchy built;
  std::unique_ptr<Scheduler> scheduler = make_serial_scheduler();
  CrackBasis basis;
  CrackScratch scratch;
};

std::vector<Vec3f> views_of(const Hierarchy& hierarchy, const Radii& radii, int random, std::size_t per_level) {
  std::vector<Vec3f> views = random_viewpoints(hierarchy, random, 1);
  for (const AdversarialView& view : adversarial_views(hierarchy, radii, {.per_level = per_level})) {
    views.push_back(view.viewpoint);
    views.push_back(view.across);
  }
  return views;
}

void expect_twins_agree(Subject& subject, const Frame& frame) {
  const CrackReport cracks = subject.cracks(frame);
  const GapReport gaps = subject.gaps(frame);
  const GapReport slow_gaps = naive_vertex_gaps(frame.context, frame.selection);
  EXPECT_EQ(cracks.open_edges, naive_residual_edges(frame.context, frame.selection));
  EXPECT_EQ(gaps.gaps, slow_gaps.gaps);
  EXPECT_EQ(gaps.gap_max, slow_gaps.gap_max);
  EXPECT_NEAR(gaps.gap_mean, slow_gaps.gap_mean, 1e-12);
  EXPECT_EQ(cracks.open_edges == 0, cracks.samples.empty());
}

// Where no point joins two parts of the surface, the two forms agree on whether there is a crack; elsewhere too a frame
// without gaps is without residual edges.
void expect_one_verdict(Subject& subject, const Frame& frame, bool manifold) {
  const bool cracked = subject.cracks(frame).open_edges > 0, gaping = subject.gaps(frame).gaps > 0;
  if (manifold) {
    EXPECT_EQ(cracked, gaping);
  } else {
    EXPECT_TRUE(gaping || !cracked);
  }
}

TEST(Cracks, NoneInAdmissibleViews) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    for (const DistanceMetric metric : both_metrics)
      for (const bool uniform : {false, true}) {
        const float rho = reach(subject.hierarchy(), metric);
        const Radii radii = uniform ? uniform_radii(subject.hierarchy(), metric, rho * 1.0001f)
                                    : per_level_radii(subject.hierarchy(), metric);
        ASSERT_TRUE(radii.admissible);
        const std::vector<Vec3f> views = views_of(subject.hierarchy(), radii, 40, 2);
        for (std::size_t i = 0; i < views.size(); ++i) {
          const Blend blend = all_blends()[i % all_blends().size()];
          const Frame frame = make_frame(subject.hierarchy(), radii, blend, views[i]);
          const CrackReport cracks = subject.cracks(frame);
          const GapReport gaps = subject.gaps(frame);
          EXPECT_EQ(cracks.open_edges, 0u);
          EXPECT_TRUE(cracks.samples.empty());
          EXPECT_EQ(cracks.uncovered_leaves, 0u);
          EXPECT_EQ(gaps.gaps, 0u);
          EXPECT_EQ(gaps.gap_max, 0);
          EXPECT_EQ(gaps.gap_mean, 0);
        }
      }
  }
}

TEST(Cracks, FastFormsEqualTheirSlowTwins) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    const bool manifold = named.name != "torn" && named.name != "non-manifold";
    std::uint64_t cracked = 0, whole = 0;
    for (const DistanceMetric metric : both_metrics)
      for (const float share : {0.3f, 0.999f, 1.001f}) {
        const Radii radii = uniform_radii(subject.hierarchy(), metric, share * reach(subject.hierarchy(), metric));
        for (const Vec3f view : views_of(subject.hierarchy(), radii, 2, 1)) {
          const Frame frame = make_frame(subject.hierarchy(), radii, Blend::smoothstep, view);
          expect_twins_agree(subject, frame);
          expect_one_verdict(subject, frame, manifold);
          (subject.cracks(frame).open_edges > 0 ? cracked : whole) += 1;
        }
      }
    EXPECT_GT(cracked, 0u);
    EXPECT_GT(whole, 0u);
  }
}

TEST(Cracks, AppearBelowTheReach) {
  for (const NamedMesh& named : manifold_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    for (const DistanceMetric metric : both_metrics) {
      const Radii wide = uniform_radii(subject.hierarchy(), metric, 2 * reach(subject.hierarchy(), metric));
      float best = 0;
      for (const AdversarialView& view : adversarial_views(subject.hierarchy(), wide))
        best = std::max(best, view.reach);
      for (const float share : {0.3f, 0.9f, 0.999f}) {
        const Radii radii = uniform_radii(subject.hierarchy(), metric, share * best);
        EXPECT_FALSE(radii.admissible);
        std::uint64_t open = 0, gaps = 0;
        for (const AdversarialView& view : adversarial_views(subject.hierarchy(), radii)) {
          const Frame frame = make_frame(subject.hierarchy(), radii, Blend::linear, view.viewpoint);
          open += subject.cracks(frame).open_edges;
          gaps += subject.gaps(frame).gaps;
        }
        EXPECT_GT(open, 0u) << share;
        EXPECT_GT(gaps, 0u) << share;
      }
    }
  }
}

// A frame that morphs for one viewpoint what was selected for another one, delta h_L away: the guard covers it.
TEST(Cracks, AStaleSelectionNeedsTheGuard) {
  constexpr float delta = 0.5f;
  for (const NamedMesh& named : manifold_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    for (const DistanceMetric metric : both_metrics)
      for (const bool guarded : {false, true}) {
        RadiiConfig config;
        config.rule = RadiiRule::uniform;
        config.metric = metric;
        config.delta = guarded ? delta : 0;
        config.kappa0 = 1.0001f * (reach(subject.hierarchy(), metric) + 3 * config.delta);
        const Radii radii = make_radii(subject.hierarchy(), config);
        ASSERT_TRUE(radii.admissible);
        std::uint64_t open = 0;
        for (const AdversarialView& view : adversarial_views(subject.hierarchy(), radii, {.per_level = 8})) {
          Frame frame = make_frame(subject.hierarchy(), radii, Blend::linear, view.viewpoint);
          const Vec3f away = view.viewpoint - subject.hierarchy().cells[view.cell].positions[view.vertex];
          for (const float side : {-0.999f, 0.999f}) {
            const float step = side * delta * cell_size(finest) / length(away);
            frame.context.viewpoint = view.viewpoint + step * away;
            open += subject.cracks(frame).open_edges;
          }
        }
        if (guarded) {
          EXPECT_EQ(open, 0u);
        } else {
          EXPECT_GT(open, 0u);
        }
      }
  }
}

// ---- hierarchies broken by hand ----

struct SharedCopy {
  std::uint32_t cell = 0, vertex = 0;
};

// A copy of a shared vertex in a cell of the level whose triangles use it.
SharedCopy find_shared_copy(const Hierarchy& hierarchy, int level) {
  std::uint32_t cell = hierarchy.levels[static_cast<std::size_t>(level)].first_cell;
  for (const Cell& c : hierarchy.cells_of(level)) {
    for (const Triangle& t : c.triangles)
      for (const std::uint32_t v : t.v)
        if (v >= c.first_shared()) return {cell, v};
    ++cell;
  }
  ADD_FAILURE() << "no shared vertex";
  return {};
}

// A frame that draws exactly the cells of one level, where lambda = `lambda_one` ? 1 : 0.
struct LevelFrame {
  Radii radii;
  Frame frame;
};

LevelFrame draw_level(const Hierarchy& hierarchy, int level, bool lambda_one) {
  LevelFrame drawn;
  const std::size_t count = hierarchy.levels.size();
  drawn.radii.select.assign(count, 0);
  drawn.radii.band_begin.assign(count, lambda_one ? 1e9f : 0.0f);
  drawn.radii.band_end.assign(count, lambda_one ? 2e9f : 1e-9f);
  drawn.radii.band_begin[0] = drawn.radii.band_end[0] = std::numeric_limits<float>::infinity();
  drawn.frame.context = {&hierarchy, nullptr, Blend::linear, {9, 9, 9}};
  const Level& l = hierarchy.levels[static_cast<std::size_t>(level)];
  for (std::uint32_t i = 0; i < l.cell_count; ++i)
    drawn.frame.selection.cells.push_back({l.first_cell + i, static_cast<std::uint8_t>(level)});
  return drawn;
}

std::uint64_t open_edges_of_level(Subject& subject, int level, bool lambda_one) {
  LevelFrame drawn = draw_level(subject.hierarchy(), level, lambda_one);
  drawn.frame.context.radii = &drawn.radii;
  expect_twins_agree(subject, drawn.frame);
  return subject.cracks(drawn.frame).open_edges;
}

TEST(Cracks, WholeLevelsHaveNone) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    for (int level = 0; level <= finest; ++level) {
      EXPECT_EQ(open_edges_of_level(subject, level, true), 0u) << level;
      EXPECT_EQ(open_edges_of_level(subject, level, false), 0u) << level;
    }
  }
}

TEST(Cracks, SeesACopyMovedByAnUlp) {
  for (int level = 1; level <= finest; ++level) {
    Subject subject(sphere_mesh(16));
    const SharedCopy copy = find_shared_copy(subject.hierarchy(), level);
    float& x = (*subject.built.payloads)[copy.cell].positions[copy.vertex].x;
    x = std::nextafter(x, 2.0f);
    EXPECT_GT(open_edges_of_level(subject, level, true), 0u) << level;
    LevelFrame drawn = draw_level(subject.hierarchy(), level, true);
    drawn.frame.context.radii = &drawn.radii;
    const GapReport gaps = subject.gaps(drawn.frame);
    EXPECT_GT(gaps.gaps, 0u);
    EXPECT_LT(gaps.gap_max, 2e-7);
  }
}

TEST(Cracks, SeesAnAlteredParent) {
  Subject subject(torus_mesh(28));
  for (int level = 1; level <= finest; ++level) {
    const std::uint32_t cell = find_shared_copy(subject.hierarchy(), level).cell;
    const std::uint32_t parent = subject.hierarchy().cells[cell].parent;
    const auto others = static_cast<std::uint32_t>(subject.hierarchy().cells[parent].positions.size());
    std::vector<std::uint32_t>& pointers = (*subject.built.payloads)[cell].parents;
    std::size_t altered = 0, seen = 0;
    for (std::size_t v = subject.hierarchy().cells[cell].first_shared(); v < pointers.size(); ++v, ++altered) {
      const std::uint32_t right = std::exchange(pointers[v], (pointers[v] + 1) % others);
      seen += open_edges_of_level(subject, level, false) > 0;
      EXPECT_EQ(open_edges_of_level(subject, level, true), 0u) << level;
      LevelFrame drawn = draw_level(subject.hierarchy(), level, false);
      drawn.frame.context.radii = &drawn.radii;
      EXPECT_GT(subject.gaps(drawn.frame).gaps, 0u) << level;
      pointers[v] = right;
    }
    // A vertex whose triangles have all collapsed onto one edge draws nothing to be torn: only the map form sees it.
    EXPECT_GT(altered, 0u);
    EXPECT_GT(seen, altered / 3) << level;
  }
}

TEST(Cracks, SeesAMissingTriangle) {
  for (int level = 0; level <= finest; ++level) {
    Subject subject(box_mesh(16));
    const std::uint32_t cell = subject.hierarchy().levels[static_cast<std::size_t>(level)].first_cell;
    (*subject.built.payloads)[cell].triangles.pop_back();
    subject.built.attach();
    subject.rebuild_basis();
    // A triangle missing at level L is a hole of the surface itself, expected there and at no other level.
    const int drawn = level == finest ? finest - 1 : level;
    EXPECT_EQ(open_edges_of_level(subject, drawn, true), 3u) << level;
    EXPECT_EQ(open_edges_of_level(subject, finest, true), 0u) << level;
  }
}

TEST(Cracks, SeesAReversedTriangle) {
  Subject subject(terrain_mesh(24));
  const std::uint32_t cell = subject.hierarchy().levels[2].first_cell;
  std::swap((*subject.built.payloads)[cell].triangles[0].v[0], (*subject.built.payloads)[cell].triangles[0].v[1]);
  subject.rebuild_basis();
  EXPECT_GT(open_edges_of_level(subject, 2, true), 0u);
}

TEST(Cracks, SeesCellsThatAreNotDrawn) {
  Subject subject(sphere_mesh(12));
  LevelFrame drawn = draw_level(subject.hierarchy(), 2, true);
  drawn.frame.context.radii = &drawn.radii;
  const LeafRange left_out = subject.basis.leaves[drawn.frame.selection.cells.back().cell];
  drawn.frame.selection.cells.pop_back();
  EXPECT_EQ(subject.cracks(drawn.frame).uncovered_leaves, left_out.size());
  EXPECT_GT(subject.cracks(drawn.frame).open_edges, 0u);
  EXPECT_EQ(subject.gaps(drawn.frame).uncovered_leaves, left_out.size());
  EXPECT_EQ(subject.gaps(drawn.frame).gaps, 0u);

  drawn.frame.selection.cells.push_back(drawn.frame.selection.cells.front());
  EXPECT_EQ(subject.cracks(drawn.frame).uncovered_leaves,
            left_out.size() + subject.basis.leaves[drawn.frame.selection.cells.front().cell].size());
}

// ---- the basis ----

std::uint64_t unpaired_count(const IndexedMesh& mesh) { return Subject(mesh).basis.unpaired.size(); }

TEST(CrackBasis, FindsTheBordersOfTheSurface) {
  EXPECT_EQ(unpaired_count(sphere_mesh(12)), 0u);
  EXPECT_EQ(unpaired_count(torus_mesh(16)), 0u);
  EXPECT_EQ(unpaired_count(terrain_mesh(20)), 80u);

  IndexedMesh one;
  one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.triangles = {{{0, 1, 2}}};
  EXPECT_EQ(unpaired_count(one), 3u);
  one.triangles.push_back({{1, 0, 2}});  // the same triangle from behind: all pair off
  EXPECT_EQ(unpaired_count(one), 0u);
}

TEST(CrackBasis, KeepsTheMultiplicityOfNonManifoldEdges) {
  // Four triangles around the edge 0-1, all in the same direction: four unpaired copies of it, in several cells.
  IndexedMesh fan;
  fan.positions = {{0.5f, 0.5f, 0}, {0.5f, 0.5f, 1}, {0, 0, 0.5f}, {1, 0, 0.5f}, {1, 1, 0.5f}, {0, 1, 0.5f}};
  for (std::uint32_t tip = 2; tip < 6; ++tip) fan.triangles.push_back({{0, 1, tip}});
  Subject subject(fan, 1);
  EXPECT_EQ(subject.hierarchy().levels[1].cell_count, 4u);
  EXPECT_EQ(subject.basis.unpaired.size(), 12u);
  for (const bool lambda_one : {false, true}) EXPECT_EQ(open_edges_of_level(subject, 1, lambda_one), 0u);

  fan.triangles[0] = {{1, 0, 2}};  // one the other way round pairs off with one of the three
  EXPECT_EQ(unpaired_count(fan), 10u);
}

TEST(CrackBasis, EqualsThatOfTheDefinition) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    const Subject subject(named.mesh);
    const Hierarchy& h = subject.hierarchy();
    std::multiset<std::array<std::uint32_t, 3>> fast, slow;
    for (std::uint32_t leaf = 0; leaf < h.levels.back().cell_count; ++leaf)
      for (const LocalEdge& e : subject.basis.unpaired_of(leaf)) fast.insert({first_leaf(h) + leaf, e.from, e.to});
    for (const NaiveHalfEdge& e : naive_unpaired(h)) slow.insert({e.cell, e.from, e.to});
    EXPECT_EQ(fast, slow);
  }
}

TEST(Cracks, TheRootAloneIsWhole) {
  Subject subject(torn_mesh(8), 0);
  const Radii radii = per_level_radii(subject.hierarchy(), DistanceMetric::euclidean);
  const Frame frame = make_frame(subject.hierarchy(), radii, Blend::linear, {0.5f, 0.5f, 0.5f});
  expect_twins_agree(subject, frame);
  EXPECT_EQ(subject.cracks(frame).open_edges, 0u);
}

TEST(Cracks, AreTheSameForAnyNumberOfWorkers) {
  Subject subject(sphere_mesh(16));
  const Radii radii = uniform_radii(subject.hierarchy(), DistanceMetric::euclidean,
                                    0.3f * reach(subject.hierarchy(), DistanceMetric::euclidean));
  const Vec3f view = adversarial_views(subject.hierarchy(), radii).front().viewpoint;
  const Frame frame = make_frame(subject.hierarchy(), radii, Blend::cosine, view);
  const CrackReport cracks = subject.cracks(frame);
  const GapReport gaps = subject.gaps(frame);
  ASSERT_GT(cracks.open_edges, 0u);
  for (const int threads : {1, 2, 3, 7}) {
    const auto scheduler = make_tbb_scheduler(threads);
    const CrackBasis basis = make_crack_basis(subject.hierarchy(), *scheduler);
    EXPECT_EQ(basis.boundary, subject.basis.boundary);
    EXPECT_EQ(basis.unpaired, subject.basis.unpaired);
    EXPECT_EQ(basis.copies, subject.basis.copies);
    CrackScratch scratch;
    const CrackReport again = residual_edges(frame.context, frame.selection, basis, *scheduler, scratch);
    EXPECT_EQ(again.open_edges, cracks.open_edges);
    ASSERT_EQ(again.samples.size(), cracks.samples.size());
    for (std::size_t i = 0; i < cracks.samples.size(); ++i) {
      EXPECT_EQ(again.samples[i].from, cracks.samples[i].from);
      EXPECT_EQ(again.samples[i].to, cracks.samples[i].to);
      EXPECT_EQ(again.samples[i].multiplicity, cracks.samples[i].multiplicity);
      EXPECT_EQ(again.samples[i].cell, cracks.samples[i].cell);
    }
    const GapReport gaps_again = vertex_gaps(frame.context, frame.selection, basis, *scheduler, scratch);
    EXPECT_EQ(gaps_again.gaps, gaps.gaps);
    EXPECT_EQ(gaps_again.gap_max, gaps.gap_max);
    EXPECT_EQ(gaps_again.gap_mean, gaps.gap_mean);
    EXPECT_EQ(gaps_again.where, gaps.where);
  }
}

}  // namespace
}  // namespace lodestone
