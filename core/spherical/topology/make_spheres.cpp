#include "core/spherical/topology/make_spheres.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "core/spherical/topology/components.h"
#include "core/spherical/topology/fill_holes.h"

namespace lodestone::spherical {
namespace {

LoopLengths lengths_of(const std::vector<ClosedHandles>& closed, double scale) {
  std::vector<double> all;
  for (const ClosedHandles& component : closed)
    for (const double length : component.lengths) all.push_back(scale * length);
  if (all.empty()) return {};
  const auto [least, greatest] = std::minmax_element(all.begin(), all.end());
  const double total = std::accumulate(all.begin(), all.end(), 0.0);
  return {*least, total / static_cast<double>(all.size()), *greatest, total};
}

}  // namespace

Spheres make_spheres(const IndexedMesh& mesh, const HandleConfig& config, const Runner& runner) {
  Manifold manifold = make_manifold(mesh);
  Spheres result{split_components(std::move(manifold.surface)), {}};
  std::vector<Surface>& surfaces = result.surfaces;
  std::vector<FilledHoles> filled(surfaces.size());
  std::vector<ClosedHandles> closed(surfaces.size());
  std::vector<BallSearch> memory(runner.workers);
  runner.run(surfaces.size(), [&](std::size_t k, std::size_t worker) {
    filled[k] = fill_holes(surfaces[k]);
    closed[k] = close_handles(surfaces[k], config, runner, memory, worker);
  });
  TopologyReport& report = result.report;
  report.manifold = manifold.repairs;
  report.components = surfaces.size();
  for (const FilledHoles& component : filled) {
    report.boundary_loops += component.loops;
    report.fill_triangles += component.triangles;
  }
  for (const ClosedHandles& component : closed) {
    report.handles += component.lengths.size();
    report.greatest_genus = std::max<std::uint64_t>(report.greatest_genus, component.lengths.size());
    report.cap_triangles += component.cap_triangles;
  }
  report.loops = lengths_of(closed, mesh.transform.scale);
  return result;
}

}  // namespace lodestone::spherical
