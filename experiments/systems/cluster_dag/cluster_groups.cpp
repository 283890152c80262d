#include "experiments/systems/cluster_dag/cluster_groups.h"

#include <metis.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "core/base/error.h"
#include "core/base/sort_unique.h"

namespace lodestone {
namespace {

struct EdgeOfCluster {
  std::uint32_t a = 0, b = 0, cluster = 0;
  friend auto operator<=>(const EdgeOfCluster&, const EdgeOfCluster&) = default;
};

// By pair of clusters, the lower one first: the number of edges that both have.
std::map<std::pair<std::uint32_t, std::uint32_t>, std::int32_t> common_edges(std::span<const Cluster* const> clusters) {
  std::vector<EdgeOfCluster> edges;
  for (std::uint32_t c = 0; c < clusters.size(); ++c)
    for (const Triangle& t : clusters[c]->triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = clusters[c]->vertices[t.v[k]], b = clusters[c]->vertices[t.v[(k + 1) % 3]];
        edges.push_back({std::min(a, b), std::max(a, b), c});
      }
  sort_unique(edges);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::int32_t> common;
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = i + 1; j < edges.size() && edges[j].a == edges[i].a && edges[j].b == edges[i].b; ++j)
      ++common[{edges[i].cluster, edges[j].cluster}];
  return common;
}

// A graph in METIS's form: the neighbours of each vertex one after the other, and the weights of the edges.
struct Graph {
  std::vector<idx_t> begin, neighbours, weights;
};

Graph graph_of(std::span<const Cluster* const> clusters) {
  std::vector<std::vector<std::pair<idx_t, idx_t>>> neighbours(clusters.size());
  for (const auto& [pair, count] : common_edges(clusters)) {
    neighbours[pair.first].emplace_back(static_cast<idx_t>(pair.second), count);
    neighbours[pair.second].emplace_back(static_cast<idx_t>(pair.first), count);
  }
  Graph graph;
  for (const auto& of_one : neighbours) {
    graph.begin.push_back(static_cast<idx_t>(graph.neighbours.size()));
    for (const auto& [to, weight] : of_one) graph.neighbours.push_back(to), graph.weights.push_back(weight);
  }
  graph.begin.push_back(static_cast<idx_t>(graph.neighbours.size()));
  return graph;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> group_clusters(std::span<const Cluster* const> clusters, std::size_t size) {
  const std::size_t wanted = (clusters.size() + size - 1) / size;
  std::vector<std::vector<std::uint32_t>> groups(wanted);
  if (wanted <= 1) {
    if (wanted == 1) groups[0].resize(clusters.size()), std::iota(groups[0].begin(), groups[0].end(), 0u);
    return groups;
  }
  Graph graph = graph_of(clusters);
  auto vertices = static_cast<idx_t>(clusters.size()), constraints = idx_t{1}, parts = static_cast<idx_t>(wanted);
  idx_t options[METIS_NOPTIONS], cut = 0;
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_UFACTOR] = 200;  // groups may be a fifth larger than the mean
  std::vector<idx_t> part(clusters.size());
  const int done =
      METIS_PartGraphKway(&vertices, &constraints, graph.begin.data(), graph.neighbours.data(), nullptr, nullptr,
                          graph.weights.data(), &parts, nullptr, nullptr, options, &cut, part.data());
  if (done != METIS_OK) throw ResourceError("METIS could not group clusters; use a smaller model");
  for (std::uint32_t c = 0; c < clusters.size(); ++c) groups[static_cast<std::size_t>(part[c])].push_back(c);
  std::erase_if(groups, [](const auto& group) { return group.empty(); });
  return groups;
}

}  // namespace lodestone
