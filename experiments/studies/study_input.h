// Parameters that several experiments have, and the way from a file to what they work on.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"
#include "core/hierarchy/model/hierarchy.h"
#include "core/hierarchy/verify/verify.h"
#include "core/mesh/indexed_mesh.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/verdict.h"
#include "parallel/hierarchy/build.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"
#include "render/camera/camera.h"

namespace lodestone {

void append(std::vector<ParameterInfo>& list, std::vector<ParameterInfo> more);

// The columns, with one more need each.
[[nodiscard]] std::vector<ColumnInfo> needing(const ColumnNeed& need, std::vector<ColumnInfo> columns);

[[nodiscard]] ParameterInfo threads_parameter();
[[nodiscard]] ParameterInfo cell_triangles_parameter();
[[nodiscard]] std::vector<ParameterInfo> build_parameters();  // how a hierarchy is built, strategy included
// Those, and what needs the whole hierarchy in memory: split edges, measured errors.
[[nodiscard]] std::vector<ParameterInfo> in_core_build_parameters();
[[nodiscard]] std::vector<ParameterInfo> picture_parameters();  // width, height, samples
// Refuses what no experiment with these parameters can run.
void check_build(SettingVerdict& verdict, const Parameters& parameters);
void check_picture(SettingVerdict& verdict, const Parameters& parameters);
[[nodiscard]] ImageSize view_size(const Parameters& parameters);

// With as many workers as `threads` says.
[[nodiscard]] std::unique_ptr<Scheduler> study_scheduler(const Parameters& parameters);
// A run at work: its setting, its files, its workers.
struct Study {
  Study(const Parameters& given, const RunContext& of_run)
      : parameters(given), context(of_run), scheduler(study_scheduler(given)) {}

  const Parameters& parameters;
  const RunContext& context;
  std::unique_ptr<Scheduler> scheduler;
};
[[nodiscard]] BuildConfig build_config(const Parameters& parameters, const RunContext& context);

// Without attributes, height grids without voids.
[[nodiscard]] ReadConfig study_reading();

// A mesh ready for everything else.
struct StudyMesh {
  IndexedMesh mesh;
  StageTime read, weld;
};
// Throws what reading and preparing throw; InputError for a run without input.
[[nodiscard]] StudyMesh read_study_mesh(const RunContext& context, Scheduler& scheduler,
                                        const ReadConfig& reading = study_reading(), Lattice lattice = {});
// The hierarchy of it, built as the in-core parameters or the others say, its errors measured if they ask for it.
[[nodiscard]] Hierarchy build_study_hierarchy(const Parameters& parameters, const RunContext& context,
                                              Scheduler& scheduler);

// Puts geometry_columns() in: distances of the mesh from the reference, both ways.
void add_geometry(Row& row, const RawMesh& reference, const RawMesh& mesh, Scheduler& scheduler);
void check_geometry(RowVerdict& verdict);

// `valid` and `failed_checks`: whether a hierarchy has every property that verify checks, compared with its input
// where that is given.
[[nodiscard]] std::vector<ColumnInfo> verify_columns();
void add_verification(Row& row, const Hierarchy& hierarchy, const Scheduler& scheduler,
                      const IndexedMesh* input = nullptr);
void check_verification(RowVerdict& verdict);

}  // namespace lodestone
