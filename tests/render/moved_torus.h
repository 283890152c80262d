// A torus as a hierarchy, and the same one far from the origin.
#pragma once

#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone::test {

inline const Hierarchy& torus() {
  static const auto small = naive_hierarchy(torus_mesh(64, 32), 2);
  return small.hierarchy;
}

inline Hierarchy moved_torus() {
  Hierarchy h = torus();
  h.transform = {{-2e6, 5e5, 1e3}, 350};
  return h;
}

}  // namespace lodestone::test
