// Parts of a model that are too small for the maps: a scrap of a scan that a pixel or two see is no mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/reconstruct/merge.h"

namespace lodestone {

struct LostParts {
  std::size_t parts = 0, triangles = 0;
};

// Takes over the parts of `mesh` (what hangs together by its vertices) that no vertex of `merged` has seen, simplified
// to as many triangles as samples of this spacing would give them; parts of less than a quarter of a sample's area are
// left out. `source`: of each vertex of `merged` the triangle that it saw, or no_source; grows with it. What is added
// is manifold: triangles that share an edge with two others, or run the other way round, are left out; and, with
// `closed`, parts that have a border then.
LostParts take_over_lost_parts(const IndexedMesh& mesh, double spacing, MergedMesh& merged,
                               std::vector<std::uint32_t>& source, bool closed, Scheduler& scheduler);

}  // namespace lodestone
