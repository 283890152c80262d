// Hierarchies broken by hand: both forms of the crack metric see the fault.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "experiments/metrics/cracks/crack_basis.h"
#include "tests/experiments/metrics/crack_subject.h"

namespace lodestone {
namespace {

using namespace testing;

struct SharedCopy {
  CellId cell;
  VertexId vertex;
};

// A copy of a shared vertex in a cell of the level whose triangles use it.
SharedCopy find_shared_copy(const Hierarchy& hierarchy, int level) {
  CellId cell = hierarchy.levels[static_cast<std::size_t>(level)].first_cell;
  for (const Cell& c : hierarchy.cells_of(level)) {
    for (const Triangle& t : c.triangles)
      for (const std::uint32_t v : t.v)
        if (v >= c.first_shared()) return {cell, VertexId(v)};
    ++cell;
  }
  ADD_FAILURE() << "no shared vertex";
  return {};
}

TEST(CrackFaults, WholeLevelsHaveNone) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    for (int level = 0; level <= finest; ++level) {
      EXPECT_EQ(open_edges_of_level(subject, level, true), 0u) << level;
      EXPECT_EQ(open_edges_of_level(subject, level, false), 0u) << level;
    }
  }
}

TEST(CrackFaults, SeesACopyMovedByAnUlp) {
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

TEST(CrackFaults, SeesAnAlteredParent) {
  Subject subject(torus_mesh(28));
  for (int level = 1; level <= finest; ++level) {
    const CellId cell = find_shared_copy(subject.hierarchy(), level).cell;
    const CellId parent = subject.hierarchy().cells[cell].parent;
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

TEST(CrackFaults, SeesAMissingTriangle) {
  for (int level = 0; level <= finest; ++level) {
    Subject subject(box_mesh(16));
    const CellId cell = subject.hierarchy().levels[static_cast<std::size_t>(level)].first_cell;
    (*subject.built.payloads)[cell].triangles.pop_back();
    subject.built.attach();
    subject.rebuild_basis();
    // A triangle missing at level L is a hole of the surface itself, expected there and at no other level.
    const int drawn = level == finest ? finest - 1 : level;
    EXPECT_EQ(open_edges_of_level(subject, drawn, true), 3u) << level;
    EXPECT_EQ(open_edges_of_level(subject, finest, true), 0u) << level;
  }
}

TEST(CrackFaults, SeesAReversedTriangle) {
  Subject subject(terrain_mesh(24));
  const CellId cell = subject.hierarchy().levels[2].first_cell;
  std::swap((*subject.built.payloads)[cell].triangles[0].v[0], (*subject.built.payloads)[cell].triangles[0].v[1]);
  subject.rebuild_basis();
  EXPECT_GT(open_edges_of_level(subject, 2, true), 0u);
}

TEST(CrackFaults, SeesCellsThatAreNotDrawn) {
  Subject subject(sphere_mesh(12));
  LevelFrame drawn = draw_level(subject.hierarchy(), 2, true);
  drawn.frame.context.radii = &drawn.radii;
  const LeafRange left_out = subject.basis->leaves[drawn.frame.selection.cells.back().cell];
  drawn.frame.selection.cells.pop_back();
  EXPECT_EQ(subject.cracks(drawn.frame).uncovered_leaves, left_out.size());
  EXPECT_GT(subject.cracks(drawn.frame).open_edges, 0u);
  EXPECT_EQ(subject.gaps(drawn.frame).uncovered_leaves, left_out.size());
  EXPECT_EQ(subject.gaps(drawn.frame).gaps, 0u);

  drawn.frame.selection.cells.push_back(drawn.frame.selection.cells.front());
  EXPECT_EQ(subject.cracks(drawn.frame).uncovered_leaves,
            left_out.size() + subject.basis->leaves[drawn.frame.selection.cells.front().cell].size());
}

}  // namespace
}  // namespace lodestone
