// Clusters of a directed acyclic graph as a system of levels of detail.
#pragma once

#include "experiments/systems/lod_system.h"

namespace lodestone {

[[nodiscard]] LodSystem cluster_dag_system(bool measured);

}  // namespace lodestone
