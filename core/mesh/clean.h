// Cleaning, which turns a RawMesh into an IndexedMesh: the definition, and its slow, simple form.
//
// In this order: triangles with a corner that is not finite are dropped; the others are normalised into the unit cube
// by the bounding box of the vertices they use, onto a lattice if one is asked for; vertices of equal float32 position
// *after* normalisation become one, the first in the file (so that no two vertices of the model are indistinguishable
// for the rest of the program); then triangles with two equal vertices are dropped, then all but the first of triangles
// with the same vertices in the same cyclic order, then vertices that no remaining triangle uses. The rest keeps its
// order. Triangles of zero area with three distinct vertices are kept, since they hold the surface
// together.
//
// prepare_mesh (parallel/clean/prepare.h) does the same in parallel.
#pragma once

#include <span>
#include <string>

#include "core/math/vec3.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// The transform that takes the longest side of the box to [0, 1]. Throws InputError when it cannot be computed in
// double precision (extent beyond 1e308, or positive and below 1e-308). A box without extent gives scale 1.
[[nodiscard]] Transform normalising_transform(const Box3d& box, const std::string& name = {});

// Coordinates in [0, 1], never -0. Rounded once, to the lattice or to float32.
[[nodiscard]] inline Vec3f normalise(const Transform& transform, Vec3d position) {
  if (transform.lattice) return transform.lattice.nearest((1 / transform.scale) * (position - transform.origin));
  const Vec3f p = transform.to_normalised(position);
  return {(p.x < 1.0f ? p.x : 1.0f) + 0.0f, (p.y < 1.0f ? p.y : 1.0f) + 0.0f, (p.z < 1.0f ? p.z : 1.0f) + 0.0f};
}

// The same cyclic order, beginning with the smallest id.
[[nodiscard]] constexpr Triangle canonical(const Triangle& t) {
  if (t.v[0] < t.v[1]) return t.v[0] < t.v[2] ? t : Triangle{{t.v[2], t.v[0], t.v[1]}};
  return t.v[1] < t.v[2] ? Triangle{{t.v[1], t.v[2], t.v[0]}} : Triangle{{t.v[2], t.v[0], t.v[1]}};
}

// Returns `asked`, or the result of choose_lattice if that is Lattice::automatic. Throws InputError when it is out of
// range.
[[nodiscard]] Lattice resolve_lattice(Lattice asked, std::span<const Vec3d> positions,
                                      std::span<const Triangle> triangles, double scale);

// Throws InputError with the reasons when no triangle is left; `name` stands for the mesh in messages.
void require_survivors(const IndexedMesh& mesh, const Repairs& repairs, const std::string& name);

// Cleans on one thread with ordered maps. `repairs` is overwritten. Merged vertices count as welded, all others that
// are dropped as unreferenced: input vertices = output vertices + welded + unreferenced. Every index of raw is in
// range. `lattice`: none, one, or Lattice::automatic.
[[nodiscard]] IndexedMesh clean_mesh(const RawMesh& raw, Repairs& repairs, const std::string& name = {},
                                     Lattice lattice = {});

}  // namespace lodestone
