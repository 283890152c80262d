// Verifies a hierarchy by several threads, each its cells.
#pragma once

#include "core/hierarchy/verify/verify.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// verify_hierarchy by as many threads of its own as the scheduler has workers, so that nothing that needs the scheduler
// runs meanwhile; the same report, but for which of several failures a check names. With wedges: by the calling thread.
// `progress` is called by that one.
[[nodiscard]] VerifyReport verify_hierarchy(const Hierarchy& hierarchy, const Scheduler& scheduler,
                                            const IndexedMesh* input = nullptr, const VerifyProgress& progress = {});

}  // namespace lodestone
