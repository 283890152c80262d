// The positions that the gl backend draws, captured from the program that draws: against the CPU's morph, and without
// cracks, bit for bit.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <span>

#include "experiments/metrics/cracks/adversary.h"
#include "render/backends/gl/scene/places.h"
#include "render/camera/camera.h"
#include "render/lod/limits.h"
#include "tests/render/backends/gl_fixture.h"
#include "tests/render/own_blends.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

// One drawn corner: its position and the vertex that it is a copy of.
struct Corner {
  Vec3f drawn;
  CellId cell;
  VertexId vertex;
};

// Captured corners with their cell and vertex, in drawing order. Empty when the count is wrong.
std::vector<Corner> corners_of(GlRenderer& renderer, const WholeFrame& whole) {
  const std::vector<Vec3f> captured = renderer.capture(whole.frame);
  std::vector<Corner> corners;
  for (const SelectedCell& selected : whole.selection.cells)
    for (const Triangle& t : whole.frame.only().morph.hierarchy->cells[selected.cell].triangles)
      for (const std::uint32_t v : t.v) {
        if (corners.size() == captured.size()) return {};
        corners.push_back({captured[corners.size()], selected.cell, VertexId(v)});
      }
  return corners.size() == captured.size() ? corners : std::vector<Corner>{};
}

// Directed edges that the drawn triangles of a closed surface do not run through as often in one direction as in the
// other: its cracks.
std::size_t open_edges(const std::vector<Corner>& corners) {
  std::map<std::pair<PositionKey, PositionKey>, int> chain;
  for (std::size_t t = 0; t < corners.size(); t += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const PositionKey from = key_of(corners[t + k].drawn), to = key_of(corners[t + (k + 1) % 3].drawn);
      if (from == to) continue;
      chain[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  return static_cast<std::size_t>(
      std::count_if(chain.begin(), chain.end(), [](const auto& edge) { return edge.second != 0; }));
}

std::vector<Camera> cameras() {
  std::vector<Camera> all;
  for (const double d : {1.6, 1.1, 0.8, 0.62, 0.5, 0.41, 0.33})
    all.push_back({{0.5 + 0.7 * d, 0.5 - 0.5 * d, 0.15 + 0.45 * d}, {0.5, 0.5, 0.15}});
  return all;
}

const NaiveHierarchy& closed_surface() {
  static const NaiveHierarchy surface = naive_hierarchy(torus_mesh(128, 64), 4);
  return surface;
}

class GlMorphTest : public GlTest, public ::testing::WithParamInterface<std::tuple<Blend, DistanceMetric>> {
 protected:
  [[nodiscard]] static Blend blend_under_test() { return std::get<0>(GetParam()); }
  [[nodiscard]] static DistanceMetric metric() { return std::get<1>(GetParam()); }
};

TEST_P(GlMorphTest, DrawsWhatTheCpuMorphs) {
  const Hierarchy& hierarchy = closed_surface().hierarchy;
  renderer_->upload(hierarchy);
  std::size_t between = 0, exact = 0, inexact = 0;
  for (const Camera& camera : cameras()) {
    WholeFrame whole(hierarchy, with_kappa0(2.5f, metric()), camera, blend_under_test());
    const std::vector<Corner> corners = corners_of(*renderer_, whole);
    ASSERT_FALSE(corners.empty());
    for (const Corner& corner : corners) {
      const int level = hierarchy.level_of(corner.cell);
      const Cell& cell = hierarchy.cells[corner.cell];
      const Vec3f w = cell.positions[corner.vertex];
      const Vec3f parent = level == 0 ? w : hierarchy.cells[cell.parent].positions[cell.parents[corner.vertex]];
      const Vec3f expected = morph_position(whole.frame.only().morph, level, w, parent);
      // `step` may jump a rounding error earlier or later.
      const float away = std::min(
          length(corner.drawn - expected),
          blend_under_test() == Blend::step ? std::min(length(corner.drawn - w), length(corner.drawn - parent)) : 1.0f);
      ASSERT_LE(away, 1e-6f);
      // Outside the band the end points are reached bit for bit; within it `linear` is never at one of them.
      MorphContext linear = whole.frame.only().morph;
      linear.blend = Blend::linear;
      const float lambda = morph_lambda(linear, level, w);
      if (lambda == 0 || lambda == 1)
        ++(corner.drawn == expected ? exact : inexact);
      else
        ++between;
    }
  }
  EXPECT_GT(exact, 10'000u);
  EXPECT_LT(1000 * inexact, exact);  // distances that round to the other side of the band's end
  EXPECT_GT(between, 1000u);
}

TEST_P(GlMorphTest, DrawsNoCracks) {
  const Hierarchy& hierarchy = closed_surface().hierarchy;
  renderer_->upload(hierarchy);
  std::size_t levels_met = 0;
  for (const Camera& camera : cameras())
    for (const float kappa0 : {0.5f, 2.5f}) {
      WholeFrame whole(hierarchy, with_kappa0(kappa0, metric()), camera, blend_under_test());
      ASSERT_TRUE(whole.radii.admissible);
      const auto [coarse, fine] = std::minmax_element(whole.selection.cells.begin(), whole.selection.cells.end(),
                                                      [](auto& a, auto& b) { return a.level < b.level; });
      levels_met = std::max(levels_met, std::size_t{1} + fine->level - coarse->level);
      const std::vector<Corner> corners = corners_of(*renderer_, whole);
      ASSERT_FALSE(corners.empty());
      EXPECT_EQ(open_edges(corners), 0u) << name_of(blend_under_test()) << " kappa0 " << kappa0;
    }
  EXPECT_GE(levels_met, 3u);
}

// A streamed hierarchy: families come and go at random, and limits stand in for those that are missing.
TEST_P(GlMorphTest, DrawsNoCracksWhileFamiliesComeAndGo) {
  const Hierarchy& whole_hierarchy = closed_surface().hierarchy;
  Hierarchy streamed = whole_hierarchy;
  for (Cell& cell : streamed.cells)
    if (cell.parent != no_cell) cell.positions = {}, cell.normals = {}, cell.parents = {}, cell.triangles = {};
  renderer_->upload(streamed);
  std::vector<char> there(streamed.cells.size(), 0);  // the children of the cell
  std::mt19937 random(3);
  std::size_t limits = 0, finest = 0;
  for (int i = 0; i < 24; ++i) {
    std::vector<CellId> came, went;
    for (CellId c{0}; c < streamed.cells.size(); ++c) {
      const Cell& cell = streamed.cells[c];
      const bool stays = random() % 8 > 0 && (cell.parent == no_cell || there[cell.parent]);
      if (cell.child_count == 0 || there[c] == stays) continue;
      there[c] = stays;
      (stays ? came : went).push_back(c);
      for (CellId k = cell.first_child; k < cell.end_child(); ++k) {
        const Cell& from = whole_hierarchy.cells[k];
        Cell& to = streamed.cells[k];
        to.positions = stays ? from.positions : std::span<const Vec3f>{};
        to.normals = stays ? from.normals : std::span<const PackedNormal>{};
        to.parents = stays ? from.parents : std::span<const std::uint32_t>{};
        to.triangles = stays ? from.triangles : std::span<const Triangle>{};
      }
    }
    renderer_->refresh(0, went, came);
    WholeFrame whole(streamed, with_kappa0(2.5f, metric()), cameras()[static_cast<std::size_t>(i) % cameras().size()],
                     blend_under_test());
    LimitTracker tracker;
    tracker.update(
        streamed, whole.radii, whole.frame.only().morph.viewpoint,
        [&](CellId cell) { return there[cell] ? ChildState::there : ChildState::missing; }, 1);
    whole.frame.only().morph.limits = tracker.limits();
    select_cells(streamed, whole.radii, whole.frame.only().morph.viewpoint, {.limits = tracker.limits()},
                 whole.selection);
    limits += tracker.limits().size();
    for (const SelectedCell& s : whole.selection.cells) finest = std::max<std::size_t>(finest, s.level);
    const std::vector<Corner> corners = corners_of(*renderer_, whole);
    ASSERT_FALSE(corners.empty());
    EXPECT_EQ(open_edges(corners), 0u) << name_of(blend_under_test());
  }
  EXPECT_GT(limits, 20u);
  EXPECT_EQ(finest, 4u);
}

INSTANTIATE_TEST_SUITE_P(AllVariants, GlMorphTest,
                         ::testing::Combine(::testing::ValuesIn(test::blends_and_own()),
                                            ::testing::Values(DistanceMetric::euclidean, DistanceMetric::chebyshev)),
                         [](const auto& instance) {
                           std::string name(name_of(std::get<0>(instance.param)));
                           std::ranges::replace_if(
                               name, [](char c) { return !std::isalnum(c); }, '_');
                           const bool euclidean = std::get<1>(instance.param) == DistanceMetric::euclidean;
                           return name + (euclidean ? "_euclidean" : "_chebyshev");
                         });

// The check above can see cracks: below the admissible border, from adversarial viewpoints, there are some.
TEST_F(GlTest, CracksAreSeenWhereTheRadiiAreInadmissible) {
  const Hierarchy& hierarchy = closed_surface().hierarchy;
  renderer_->upload(hierarchy);
  const RadiiConfig config = with_kappa0(0.6f * greatest_reach(hierarchy, DistanceMetric::euclidean),
                                         DistanceMetric::euclidean, RadiiRule::uniform);
  std::size_t open = 0;
  for (const AdversarialView& view : adversarial_views(hierarchy, make_radii(hierarchy, config))) {
    const Vec3d eye = to_double(view.viewpoint);
    WholeFrame whole(hierarchy, config, {eye, eye + Vec3d{1, 0, 0}}, Blend::linear);
    ASSERT_FALSE(whole.radii.admissible);
    open += open_edges(corners_of(*renderer_, whole));
  }
  EXPECT_GT(open, 0u);
}

// Copies of a vertex in cells of one level have the same position, also on open surfaces.
TEST_F(GlTest, CopiesOfAVertexStandTogether) {
  const NaiveHierarchy terrain = naive_hierarchy(terrain_mesh(96), 3);
  renderer_->upload(terrain.hierarchy);
  for (const Camera& camera : cameras()) {
    WholeFrame whole(terrain.hierarchy, with_kappa0(2), camera);
    std::map<std::pair<int, PositionKey>, PositionKey> place;
    for (const Corner& corner : corners_of(*renderer_, whole)) {
      const PositionKey own = key_of(terrain.hierarchy.cells[corner.cell].positions[corner.vertex]);
      const auto [entry, added] =
          place.try_emplace({terrain.hierarchy.level_of(corner.cell), own}, key_of(corner.drawn));
      ASSERT_EQ(entry->second, key_of(corner.drawn));
    }
    ASSERT_FALSE(place.empty());
  }
}

// The static path is an economy: without it the same bits come out.
TEST_F(GlTest, StaticCellsStandWhereMorphingOnesWould) {
  const Hierarchy& hierarchy = closed_surface().hierarchy;
  renderer_->upload(hierarchy);
  std::size_t static_cells = 0;
  for (const Camera& camera : cameras()) {
    WholeFrame whole(hierarchy, with_kappa0(4), camera, Blend::linear);
    const std::vector<Vec3f> economical = renderer_->capture(whole.frame);
    for (SelectedCell& selected : whole.selection.cells) {
      static_cells += !selected.morphing;
      selected.morphing = true;
    }
    EXPECT_EQ(renderer_->capture(whole.frame), economical);
  }
  EXPECT_GT(static_cells, 0u);
}

// Cut into groups, each family with a copy of its parent: the same triangles in the same order (of those at one depth
// the first is seen), the same picture, also where cells are drawn in parts.
TEST_F(GlTest, GroupsChangeNothing) {
  const Hierarchy& hierarchy = closed_surface().hierarchy;
  std::uint64_t largest = 0;
  for (CellId c{0}; c < hierarchy.cells.size(); ++c)
    largest = std::max(largest, GlPlaces::family_size(hierarchy, c).vertices);
  const auto cut = make_gl_renderer({.max_storage_block_bytes = largest * sizeof(Vec3f)});
  cut->upload(hierarchy);
  renderer_->upload(hierarchy);
  EXPECT_EQ(renderer_->group_count(), 1u);
  EXPECT_GT(cut->group_count(), 3u);
  for (const Camera& camera : cameras()) {
    WholeFrame whole(hierarchy, with_kappa0(2.5f), camera);
    const auto expect_equal = [&] {
      EXPECT_EQ(cut->draw(whole.frame).triangles, renderer_->draw(whole.frame).triangles);
      EXPECT_EQ(cut->read_back().rgba, renderer_->read_back().rgba);
      EXPECT_EQ(cut->capture(whole.frame), renderer_->capture(whole.frame));
    };
    expect_equal();
    std::vector<std::array<TriangleRange, 2>> parts;
    for (const SelectedCell& selected : whole.selection.cells) {
      const auto triangles = static_cast<std::uint32_t>(hierarchy.cells[selected.cell].triangles.size());
      parts.push_back({{{0, triangles / 3}, {triangles / 2, triangles}}});
    }
    for (std::size_t k = 0; k < parts.size(); ++k) whole.selection.cells[k].ranges = parts[k];
    expect_equal();
  }
}

}  // namespace
}  // namespace lodestone
