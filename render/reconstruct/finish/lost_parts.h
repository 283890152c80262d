// Parts of a model that are too small for the maps: a fragment of a scan that only one or two pixels see gives no mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/reconstruct/merge/merge.h"
#include "render/reconstruct/report/report.h"

namespace lodestone {

// Takes over the parts of `mesh` (connected by vertices) that no vertex of `merged` has seen, simplified to as many
// triangles as samples of this spacing would give them; parts of less than a quarter of a sample's area are left out.
// `source`: the triangle that each vertex of `merged` saw, or no_source; grows with it. The added parts are manifold:
// triangles that share an edge with two others, or have the opposite orientation, are left out; and, with `closed`,
// parts that then have a border.
LostParts take_over_lost_parts(const IndexedMesh& mesh, double spacing, MergedMesh& merged,
                               std::vector<std::uint32_t>& source, bool closed, Scheduler& scheduler);

}  // namespace lodestone
