// Making a mesh progressive, on all cores.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/progressive/collapse/metric_kind.h"
#include "core/progressive/mesh/progressive_mesh.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

enum class InstructionSet;  // core/base/instruction_set.h

struct ProgressiveConfig {
  progressive::MetricKind metric = progressive::MetricKind::quadric;
  progressive::AttributeWeights weights{};
  std::size_t base_triangles = 0;    // to stop at; 0: what remains when nothing can collapse
  std::size_t finest_triangles = 0;  // at most, as far as the base allows; 0: all
  InstructionSet instructions = {};  // the best one
};

struct ProgressiveReport {
  std::uint64_t cut_vertices = 0;  // copies made where the surface was cut apart
  std::uint64_t cut_edges = 0;     // of three or more triangles, or of triangles turned against each other
  std::uint64_t input_triangles = 0, base_triangles = 0;
  double finest_error = 0;   // bound of the distance of the finest level from the input, in units of the model
  std::uint64_t rounds = 0;  // of regions side by side, before the rest was collapsed as one
};

// Collapses the mesh by half-edges, cheapest first. While it is large that happens in regions, cubes of a grid that
// moves from round to round: what a region's border holds in place in one round is free in the next, and no round goes
// far beyond the ranks that others have reached. The result depends only on the mesh and the configuration.
//
// Memory at the peak: about 110 bytes per triangle without attributes, besides the mesh. Throws InputError when the
// mesh lacks what the metric measures.
[[nodiscard]] ProgressiveMesh make_progressive(const IndexedMesh& mesh, const ProgressiveConfig& config,
                                               Scheduler& scheduler, ProgressiveReport& report);
// The same, of a mesh that is not needed any more: its textures are not copied.
[[nodiscard]] ProgressiveMesh make_progressive(IndexedMesh&& mesh, const ProgressiveConfig& config,
                                               Scheduler& scheduler, ProgressiveReport& report);

}  // namespace lodestone
