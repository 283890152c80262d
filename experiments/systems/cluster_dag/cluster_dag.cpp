#include "experiments/systems/cluster_dag/cluster_dag.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/spatial/triangle_bvh.h"
#include "experiments/systems/cluster_dag/cluster_groups.h"
#include "experiments/systems/cluster_dag/cluster_mesh.h"

namespace lodestone {
namespace {

// Groups that keep more of their triangles than this are stuck: they remain as they are, and so do their vertices.
constexpr double stuck = 0.85;
constexpr double outward = 1 + 1e-9;  // for the rounding of balls within balls

Vec3d middle(const Triangle& t, std::span<const Vec3d> at) {
  return (1.0 / 3) * (at[t.v[0]] + at[t.v[1]] + at[t.v[2]]);
}

std::vector<Vec3d> doubles(std::span<const Vec3f> positions) {
  std::vector<Vec3d> all;
  for (const Vec3f p : positions) all.push_back(to_double(p));
  return all;
}

ErrorBall around(const Cluster& cluster, std::span<const Vec3f> positions) {
  ErrorBall ball;
  for (const std::uint32_t v : cluster.vertices)
    ball.centre = ball.centre + (1.0 / static_cast<double>(cluster.vertices.size())) * to_double(positions[v]);
  for (const std::uint32_t v : cluster.vertices)
    ball.radius = std::max(ball.radius, length(to_double(positions[v]) - ball.centre) * outward);
  return ball;
}

// A cluster that still takes part, and the vertices of the surface that are nearest to it, if errors are measured.
struct Open {
  std::uint32_t cluster = 0;
  std::vector<std::uint32_t> nearest_to;
};

struct Replacement {
  std::vector<Cluster> clusters;  // none: the group is stuck
  std::vector<std::vector<std::uint32_t>> nearest_to;
  ErrorBall ball;
};

class DagBuilder {
 public:
  DagBuilder(std::span<const Vec3f> positions, std::span<const Triangle> triangles, const ClusterDagConfig& config,
             Scheduler& scheduler)
      : positions_(positions), config_(config), scheduler_(scheduler), fixed_(positions.size(), 0) {
    if (config.measured) surface_.emplace(doubles(positions), triangles);
    add_surface(triangles);
  }

  std::vector<Cluster> build() {
    while (open_.size() > 1) {
      const std::vector<std::vector<std::uint32_t>> groups = group();
      const std::vector<std::uint8_t> locked = lock(groups);
      std::vector<Replacement> made(groups.size());
      scheduler_.for_chunks(groups.size(), 1,
                            [&](ChunkRange range) { made[range.begin] = replace(groups[range.begin], locked); });
      if (!take_over(groups, made)) break;
    }
    return std::move(clusters_);
  }

 private:
  void add_surface(std::span<const Triangle> triangles) {
    if (triangles.empty()) return;
    std::vector<std::uint8_t> taken(positions_.size(), 0);
    for (Cluster& cluster : cut_into_clusters(part_mesh(triangles, positions_), config_)) {
      cluster.own = around(cluster, positions_);
      Open open{static_cast<std::uint32_t>(clusters_.size()), {}};
      for (const std::uint32_t v : cluster.vertices)
        if (config_.measured && !std::exchange(taken[v], 1)) open.nearest_to.push_back(v);
      clusters_.push_back(std::move(cluster));
      open_.push_back(std::move(open));
    }
  }

  [[nodiscard]] std::vector<std::vector<std::uint32_t>> group() const {
    std::vector<const Cluster*> clusters;
    for (const Open& open : open_) clusters.push_back(&clusters_[open.cluster]);
    return group_clusters(clusters, config_.group_clusters);
  }

  // By vertex of the surface: several groups use it, or a group that was stuck.
  [[nodiscard]] std::vector<std::uint8_t> lock(const std::vector<std::vector<std::uint32_t>>& groups) const {
    constexpr auto none = ~std::uint32_t{0};
    std::vector<std::uint8_t> locked = fixed_;
    std::vector<std::uint32_t> user(positions_.size(), none);
    for (std::uint32_t g = 0; g < groups.size(); ++g)
      for (const std::uint32_t o : groups[g])
        for (const std::uint32_t v : clusters_[open_[o].cluster].vertices) {
          if (user[v] != none && user[v] != g) locked[v] = 1;
          user[v] = g;
        }
    return locked;
  }

  [[nodiscard]] Replacement replace(const std::vector<std::uint32_t>& group,
                                    std::span<const std::uint8_t> locked) const {
    std::vector<Triangle> triangles;
    Replacement made;
    std::uint8_t step = 0;
    for (const std::uint32_t o : group) {
      const Cluster& cluster = clusters_[open_[o].cluster];
      for (const Triangle& t : cluster.triangles)
        triangles.push_back({{cluster.vertices[t.v[0]], cluster.vertices[t.v[1]], cluster.vertices[t.v[2]]}});
      made.ball.centre = made.ball.centre + (1.0 / static_cast<double>(group.size())) * cluster.own.centre;
      made.ball.error = std::max(made.ball.error, cluster.own.error);
      step = std::max(step, cluster.step);
    }
    for (const std::uint32_t o : group) {
      const ErrorBall& ball = clusters_[open_[o].cluster].own;
      made.ball.radius = std::max(made.ball.radius, (length(ball.centre - made.ball.centre) + ball.radius) * outward);
    }

    PartMesh mesh = part_mesh(triangles, positions_);
    std::vector<std::uint8_t> stays;
    for (const std::uint32_t v : mesh.vertices) stays.push_back(locked[v]);
    Simplified simplified = simplify_to_half(mesh, stays);
    const auto before = static_cast<double>(mesh.triangles.size());
    if (simplified.triangles.empty() || static_cast<double>(simplified.triangles.size()) > stuck * before) return {};
    mesh.triangles = std::move(simplified.triangles);
    made.clusters = cut_into_clusters(mesh, config_);
    made.ball.error = std::max(made.ball.error, config_.measured ? measure(mesh, group, made) : simplified.error);
    for (Cluster& cluster : made.clusters) cluster.own = made.ball, cluster.step = static_cast<std::uint8_t>(step + 1);
    return made;
  }

  // The largest distance between the new triangles of a group and the surface. Each vertex of the surface that was
  // nearest to one of the group goes on with the cluster that is nearest to it now.
  [[nodiscard]] double measure(const PartMesh& mesh, const std::vector<std::uint32_t>& group, Replacement& made) const {
    const std::vector<Vec3d> at = doubles(mesh.positions);
    double farthest = 0;
    const auto see = [&](Vec3d p) { farthest = std::max(farthest, surface_->nearest(p).squared_distance); };
    for (const Triangle& t : mesh.triangles) see(middle(t, at));  // vertices lie on the surface

    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> owner;
    for (std::uint32_t c = 0; c < made.clusters.size(); ++c)
      for (const Triangle& t : made.clusters[c].triangles) {
        const auto place = [&](std::uint32_t v) {
          return static_cast<std::uint32_t>(std::ranges::lower_bound(mesh.vertices, made.clusters[c].vertices[v]) -
                                            mesh.vertices.begin());
        };
        triangles.push_back({{place(t.v[0]), place(t.v[1]), place(t.v[2])}});
        owner.push_back(c);
      }
    const TriangleBvh coarse(at, triangles);
    made.nearest_to.resize(made.clusters.size());
    std::uint32_t hint = TriangleBvh::no_hint;
    for (const std::uint32_t o : group)
      for (const std::uint32_t v : open_[o].nearest_to) {
        const TriangleBvh::Nearest nearest = coarse.nearest(to_double(positions_[v]), hint);
        hint = nearest.slot;
        farthest = std::max(farthest, nearest.squared_distance);
        made.nearest_to[owner[coarse.triangle(nearest.slot)]].push_back(v);
      }
    return std::sqrt(farthest);
  }

  // False where all groups are stuck.
  bool take_over(const std::vector<std::vector<std::uint32_t>>& groups, std::vector<Replacement>& made) {
    std::vector<Open> next;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (const std::uint32_t o : groups[g]) {
        Cluster& cluster = clusters_[open_[o].cluster];
        if (!made[g].clusters.empty()) cluster.replaced = made[g].ball;
        if (made[g].clusters.empty())
          for (const std::uint32_t v : cluster.vertices) fixed_[v] = 1;
      }
      for (std::size_t c = 0; c < made[g].clusters.size(); ++c) {
        Open open{static_cast<std::uint32_t>(clusters_.size()), {}};
        if (config_.measured) open.nearest_to = std::move(made[g].nearest_to[c]);
        clusters_.push_back(std::move(made[g].clusters[c]));
        next.push_back(std::move(open));
      }
    }
    open_ = std::move(next);
    return !open_.empty();
  }

  std::span<const Vec3f> positions_;
  ClusterDagConfig config_;
  Scheduler& scheduler_;
  std::optional<TriangleBvh> surface_;
  std::vector<Cluster> clusters_;
  std::vector<Open> open_;
  std::vector<std::uint8_t> fixed_;  // by vertex of the surface
};

}  // namespace

std::vector<Cluster> build_cluster_dag(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                                       const ClusterDagConfig& config, Scheduler& scheduler) {
  return DagBuilder(positions, triangles, config, scheduler).build();
}

bool is_good_enough(const ErrorBall& ball, Vec3d viewpoint, double reach) {
  return ball.error * reach <= std::max(length(viewpoint - ball.centre) - ball.radius, 0.0);
}

}  // namespace lodestone
