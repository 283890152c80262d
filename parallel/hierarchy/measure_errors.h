// The errors of a finished hierarchy, measured instead of estimated: bounds with a proof, both ways.
#pragma once

#include <cstdint>
#include <functional>

#include "core/hierarchy/model/hierarchy.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct MeasureConfig {
  // An error may be larger than the distance that it bounds by this share. Above 0; smaller takes longer.
  double tolerance = 0.05;
  // Distances between a point and a triangle that may be computed per triangle of the finest level, on all levels
  // together, beside those of a first pass: a limit on the time, some 15 us per thousand. Surfaces without needles need
  // a tenth. 0: none.
  double tests = 1200;
  const CancelFlag* cancel = nullptr;
  // Called now and then, from any thread but one at a time, with the share done in [0, 1].
  std::function<void(double)> progress = {};
};

struct MeasureReport {
  std::uint64_t queries = 0, pieces = 0, tests = 0;  // of distances, as CellErrorMeter counts them
  std::uint64_t stopped = 0;                         // cells whose tests ran out
  double excess = 0;                                 // h_l; by how much an error may be too large, at most
};

// Replaces the errors of all cells and levels except for the finest one's: that is the distance by which the input was
// moved, and is added to all others. A cell's error becomes the largest of its children's and of its own bound, which
// is at most 1 + tolerance times its distance (see core/hierarchy/construct/cell_error.h) or 1e-5 h, whichever is
// larger; errors of cells whose tests run out are bounds, too, but may exceed that (MeasureReport). The same for any
// number of workers.
//
// Memory, with the hierarchy: search structures of the finest and of one more level, about 30 bytes per triangle of
// the finest level, up to four times that for needles, and little for each worker. Throws Cancelled.
MeasureReport measure_errors(Hierarchy& hierarchy, const MeasureConfig& config, Scheduler& scheduler);

}  // namespace lodestone
