// The work of experiment `scaling`: jobs that any number of workers does, to the same result.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "experiments/studies/experiment.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// A job for one number of workers, of one amount of work. The scheduler outlives it.
class ScalingJob {
 public:
  virtual ~ScalingJob() = default;
  virtual void prepare() {}  // before each round, not timed
  virtual void run() = 0;
  [[nodiscard]] virtual double work() const = 0;         // amount done by run(), in any unit
  [[nodiscard]] virtual std::uint64_t hash() const = 0;  // of what the last run() made
};

[[nodiscard]] const std::vector<std::string>& scaling_tasks();  // build, raster, reconstruct, progressive

// `times`: how much work, 1 for the input as it is. Building and collapsing take as many copies of the mesh, side by
// side; drawing and reconstructing as many times the pixels.
[[nodiscard]] std::unique_ptr<ScalingJob> make_scaling_job(const IndexedMesh& mesh, const Parameters& parameters,
                                                           const RunContext& context, int times, Scheduler& scheduler);

// As many copies of a mesh, on a grid as nearly cubic as may be, a hundredth of their size apart.
[[nodiscard]] IndexedMesh side_by_side(const IndexedMesh& mesh, int copies, Scheduler& scheduler);

}  // namespace lodestone
