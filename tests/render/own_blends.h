// Blending functions of a user's own, for tests that go through all there are.
#pragma once

#include <vector>

#include "render/lod/blend.h"

namespace lodestone::test {

// A table with a flat piece, and polynomials of degree 2, 3 and 5.
inline std::vector<Blend> own_blends() {
  return {blend_named("table:0,0.125,0.125,0.875,1"), blend_named("polynomial:0,0.5,0.5"),
          blend_named("polynomial:0,0,3,-2"), blend_named("polynomial:0,0,0,10,-15,6")};
}

inline std::vector<Blend> blends_and_own() {
  std::vector<Blend> all(all_blends().begin(), all_blends().end());
  for (const Blend own : own_blends()) all.push_back(own);
  return all;
}

}  // namespace lodestone::test
