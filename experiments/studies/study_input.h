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
#include "experiments/studies/setting_verdict.h"
#include "parallel/build/build.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"
#include "render/camera/camera.h"

namespace lodestone {

void append(std::vector<ParameterInfo>& list, std::vector<ParameterInfo> more);
void append(std::vector<ColumnInfo>& list, std::vector<ColumnInfo> more);

// The columns, with one more need each.
[[nodiscard]] std::vector<ColumnInfo> needing(const ColumnNeed& need, std::vector<ColumnInfo> columns);

[[nodiscard]] ParameterInfo threads_parameter();
[[nodiscard]] std::vector<ParameterInfo> build_parameters();    // how a hierarchy is built, strategy included
// Those, and what needs the whole hierarchy in memory: split edges, measured errors.
[[nodiscard]] std::vector<ParameterInfo> in_core_build_parameters();
[[nodiscard]] std::vector<ParameterInfo> picture_parameters();  // width, height, samples
// What an experiment with these parameters has to refuse.
void check_build(SettingVerdict& verdict, const Parameters& parameters);
void check_picture(SettingVerdict& verdict, const Parameters& parameters);
[[nodiscard]] ImageSize view_size(const Parameters& parameters);

// As `threads` says.
[[nodiscard]] std::unique_ptr<Scheduler> study_scheduler(const Parameters& parameters);
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

// Their names, separated by commas.
[[nodiscard]] std::string failed_checks(const VerifyReport& report);

}  // namespace lodestone
