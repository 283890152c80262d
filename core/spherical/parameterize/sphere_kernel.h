// The kernel of the map to the sphere: vertices that share no edge, in blocks, moved to where the stretch of their
// triangles is smaller. Compiled for AVX2 and for any processor, equal bytes.
//
// Energy of a triangle with area A and edges of squared lengths l on the sphere, C the dot products of the edges at its
// corners on the surface: N = sum of C l, D = det of its corners on the sphere, A / 2 N / D^2 (praun2003) + guard
// A (N / 4 A^2)^3. The determinant in place of the flat area is a barrier before a flip, and an upper bound of the
// stretch of the central projection. The guard keeps triangles from shrinking to nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/instruction_set.h"
#include "core/math/lanes/double4.h"
#include "core/progressive/collapse/ring_mesh.h"

namespace lodestone::spherical {

using progressive::Id;

struct SphereState {
  const progressive::RingMesh& rings;  // closed, of the vertices that are there
  // Both by vertex.
  std::span<const AlignedPoint4d> surface;  // scaled to the area 4 pi
  std::span<AlignedPoint4d> directions;     // unit vectors, snapped
  double guard = 0;                         // its weight
  // Every triangle is measured as if an equilateral one of this area were added to its metric, so that those without
  // an area have one.
  double least_area = 0;
};

// Up to four vertices side by side, in lanes; further lanes repeat the last. Vertices of fewer faces have faces of
// weight zero at the end.
struct SweepGroup {
  std::uint32_t faces = 0;
  std::uint32_t count = 0;
  Id vertex[4]{};
};

struct SweepBlock {
  std::vector<SweepGroup> groups;
  std::vector<Id> neighbours;     // by group: the first neighbours of the four vertices, the second ones ..., the first
  std::vector<double> constants;  // by group and face: 16 numbers
};

struct SphereKernel {
  // Fills the block from the rings and the surface; the vertices share no edge. Its memory is reused.
  void (*build)(const SphereState& state, std::span<const Id> vertices, SweepBlock& block);
  // One damped Newton step of every vertex of the block. A step is taken only if the energy of the vertex falls and all
  // its triangles are positively oriented after it, exactly.
  void (*sweep)(const SphereState& state, const SweepBlock& block);
};
// The build for AVX2 is null where the compiler does not know it.
extern const SphereKernel *const plain_sphere_kernel, *const avx2_sphere_kernel;
// Throws UnsupportedError where the set is not available.
[[nodiscard]] const SphereKernel& sphere_kernel(InstructionSet set);

}  // namespace lodestone::spherical
