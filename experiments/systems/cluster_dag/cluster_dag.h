// A directed acyclic graph of clusters (karis2021), to compare with: clusters of some 128
// triangles are joined in groups, each group is simplified to half of its triangles while the vertices that it shares
// with other groups stay where they are, and the result is cut into clusters anew. Groups change from step to step, so
// that what was locked once is simplified later.
//
// Made with meshoptimizer's clusters and simplification, and METIS's partition of graphs (karypis1998), as packaged; an
// error is meshoptimizer's estimate, or measured.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// An error, and the ball in which it lies. Those of a group contain the balls of its clusters, and are no smaller than
// their errors, so that a group that is good enough from somewhere has no cluster below it that is not.
struct ErrorBall {
  Vec3d centre;
  double radius = 0, error = 0;
};

struct Cluster {
  std::vector<std::uint32_t> vertices;  // of the surface
  std::vector<Triangle> triangles;      // of places in `vertices`
  ErrorBall own;                        // of the group that it was simplified in; error 0 on the surface itself
  // Those of the group that takes its place; an infinite error where nothing does.
  ErrorBall replaced{{}, 0, std::numeric_limits<double>::infinity()};
  std::uint8_t step = 0;  // number of simplifications between the surface and it
};

struct ClusterDagConfig {
  std::size_t cluster_triangles = 128, cluster_vertices = 192, group_clusters = 8;
  // Errors are the largest distances, in both directions, between vertices and middles of triangles of a group and the
  // surface, instead of meshoptimizer's estimates.
  bool measured = false;
};

// The surface lies in the unit cube and is welded; attributes are left out. The same for any number of threads. Throws
// ResourceError where METIS runs out of memory; Cancelled.
[[nodiscard]] std::vector<Cluster> build_cluster_dag(std::span<const Vec3f> positions,
                                                     std::span<const Triangle> triangles,
                                                     const ClusterDagConfig& config, Scheduler& scheduler);

// True where the error is seen as no more than the tolerance: an error of 1 is, from `reach` on.
[[nodiscard]] bool is_good_enough(const ErrorBall& ball, Vec3d viewpoint, double reach);

// The clusters that are drawn are those that are good enough and are not replaced by others that are.
[[nodiscard]] inline bool is_drawn(const Cluster& cluster, Vec3d viewpoint, double reach) {
  return is_good_enough(cluster.own, viewpoint, reach) && !is_good_enough(cluster.replaced, viewpoint, reach);
}

}  // namespace lodestone
