// Naive hierarchies in which nearly every vertex moves at every level: what morphs wrongly is seen.
#pragma once

#include "tests/naive_hierarchy.h"

namespace lodestone::testing {

using test::NaiveHierarchy;

inline NaiveHierarchy naive_hierarchy(const IndexedMesh& mesh, int finest, float sigma0) {
  return test::naive_hierarchy(mesh, finest, sigma0, test::Representative::centre);
}

}  // namespace lodestone::testing
