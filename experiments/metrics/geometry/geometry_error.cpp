#include "experiments/metrics/geometry/geometry_error.h"

#include <algorithm>

#include "parallel/mesh/compare.h"

namespace lodestone {

GeometryError geometry_error(const RawMesh& reference, const RawMesh& mesh, const CompareConfig& config,
                             Scheduler& scheduler) {
  GeometryError error;
  error.distance = compare_meshes(reference, mesh, config, scheduler);
  error.normals = normal_deviation(reference, mesh, config, scheduler);
  error.quality = measure_quality(mesh.positions, mesh.triangles);
  const MeshDistance& d = error.distance;
  if (!(d.diagonal > 0)) return error;
  error.hausdorff = std::max(d.forward.max, d.backward.max) / d.diagonal;
  error.rms = std::max(d.forward.rms, d.backward.rms) / d.diagonal;
  error.mean = std::max(d.forward.mean, d.backward.mean) / d.diagonal;
  error.p99 = std::max(d.forward.p99, d.backward.p99) / d.diagonal;
  return error;
}

}  // namespace lodestone
