// Generated closed surfaces with many handles or components, for tests and benchmarks of what depends on topology.
//
// Each is the zero set of a field, found by marching tetrahedra: an oriented manifold with bumps, the same on every
// machine that rounds sines alike. n is the number of cubes along the longest side; triangles grow with its square.
#pragma once

#include <cstdint>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Five thick rings that melt into each other: one component of genus 5.
[[nodiscard]] IndexedMesh five_rings(std::uint32_t n);

// Beams along the edges of k^3 cubes: one component of genus 3 k (k + 1)^2 - (k + 1)^3 + 1.
[[nodiscard]] IndexedMesh truss(std::uint32_t n, std::uint32_t k);

// Scattered matter in a ball, as a scan of bone or foam has it: waves of about `frequency` to a side, cut off at
// `level`, -1 to 1. Low levels give many components, those towards 0 many handles.
struct FoamConfig {
  double frequency = 16;
  double level = -0.555;
};
[[nodiscard]] IndexedMesh foam(std::uint32_t n, const FoamConfig& config = {});

}  // namespace lodestone
