// Groups of clusters that share many edges, by METIS.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "experiments/systems/cluster_dag/cluster_dag.h"

namespace lodestone {

// Groups of about `size` clusters, as places in `clusters`. The same for the same input.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> group_clusters(std::span<const Cluster* const> clusters,
                                                                     std::size_t size);

}  // namespace lodestone
