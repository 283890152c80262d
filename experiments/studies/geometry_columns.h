// How far a level is from what it stands for, as columns: the same for every way of making levels.
#pragma once

#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/row_verdict.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

[[nodiscard]] std::vector<ColumnInfo> geometry_columns();
// Of the bounding box, in units of the mesh.
[[nodiscard]] double diagonal_of(const RawMesh& mesh);
// Measures both ways and puts in what geometry_columns() lists: 0 where it is below position_resolution.
void add_geometry(Row& row, const RawMesh& reference, const RawMesh& mesh, Scheduler& scheduler);
// Of rows that have them.
void check_geometry(RowVerdict& verdict);

}  // namespace lodestone
