#include "parallel/mesh/compare.h"

#include <optional>

#include "core/spatial/surface_samples.h"

namespace lodestone {

MeshDistance compare_meshes(const RawMesh& a, const RawMesh& b, const CompareConfig& config, Scheduler& scheduler) {
  const ComparedPair pair = prepare_comparison(a, b);
  std::optional<TriangleBvh> bvh[2];
  std::optional<SurfaceSamples> samples[2];
  std::vector<double> squared[2];
  scheduler.for_chunks(2, 1, [&](ChunkRange range) {
    const std::size_t i = range.index;
    bvh[i].emplace(pair.mesh[i].positions, pair.mesh[i].triangles);
    samples[i].emplace(samples_of(pair.mesh[i], config));
    squared[i].resize(samples[i]->size());
  });
  for (const std::size_t from : {0u, 1u})
    scheduler.for_chunks(samples[from]->size(), sample_grain, [&](ChunkRange range) {
      measure_samples(*samples[from], *bvh[1 - from], range.begin, range.end, squared[from]);
    });
  return {pair.diagonal, summarise(*samples[0], squared[0], pair.scale),
          summarise(*samples[1], squared[1], pair.scale)};
}

}  // namespace lodestone
