// Why a level keeps more than a quarter of the triangles of the next finer one: what its vertices have in common.
#pragma once

#include <cstdint>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// Vertices of a level by the first of these reasons that holds for them.
struct KeptVertices {
  int level = 0;
  std::uint64_t vertices = 0;
  std::uint64_t shared = 0;        // several cells use them: they may be locked on a border between blocks
  std::uint64_t non_manifold = 0;  // at an edge of more than two triangles, or of two that face against each other
  std::uint64_t border = 0;        // at an edge of one triangle
  std::uint64_t seams = 0;         // of several wedges
  std::uint64_t distant = 0;       // all neighbours are farther away than a vertex of the finer level may move
};

// The level below the finest that has the most triangles beyond a quarter of those of the next finer level, judged by
// some of its cells, 30,000 triangles at most. The hierarchy has payloads and two levels or more.
[[nodiscard]] KeptVertices find_kept(const Hierarchy& hierarchy);

}  // namespace lodestone
