// Verifies that the adaptive radii of a hierarchy keep the constraint that their guarantee rests on.
#pragma once

#include "core/hierarchy/verify/verify.h"
#include "parallel/scheduler/scheduler.h"
#include "render/lod/radii.h"

namespace lodestone {

// The check `radii`: the radius of every parent of a signature is at least that of each of its cells + H + (beta + 3
// delta) h (docs/decisions/0055), in double, and the radii serve the errors of cells and of signatures.
[[nodiscard]] VerifyCheck verify_radii(const Hierarchy& hierarchy, const Radii& radii, const RadiiConfig& config);

// The same for tolerances of 0.1 to 64 pixels and both metrics. O(signatures) for each of them.
[[nodiscard]] VerifyCheck verify_radii(const Hierarchy& hierarchy);

// verify_hierarchy by the scheduler's number of threads, and after its checks `radii`, if `structure` holds.
[[nodiscard]] VerifyReport verify_with_radii(const Hierarchy& hierarchy, const Scheduler& scheduler,
                                             const IndexedMesh* input = nullptr, const VerifyProgress& progress = {});

}  // namespace lodestone
