// Verifies that a hierarchy satisfies the design (docs/architecture.md, mathematics). Written independently of the
// builder, from the definitions, with sorting and plain loops. Every statement is recomputed from the payloads.
//
// Two things follow the definition and are not recomputed in another way: the barycentre in float that decides the cell
// of a triangle, and the fingerprint of a triangle. Lengths are evaluated in double; a stored bound must be no less
// than the recomputed value and at most `bound_slack` of it more.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

struct VerifyCheck {
  std::string name;
  bool passed = false;
  std::string detail;  // the number of items examined, or the first failure and the number of failures
};

struct VerifyReport {
  std::vector<VerifyCheck> checks;
  // By level: the largest distance found between a point and the other surface, over the error of the level; 0 where
  // no point is away from it, and on M_L. Measured errors are bounds, so that it is at most 1; estimates may be smaller
  // than the distance. Empty if `structure` fails.
  std::vector<double> error_ratio;
  [[nodiscard]] bool valid() const;
  [[nodiscard]] const VerifyCheck* find(const std::string& name) const;  // nullptr: no such check
};

inline constexpr double bound_slack = 1e-4;  // relative

// The checks, in this order:
//   structure      tables and payloads are consistent: ranges, Morton order, children, counts, finite numbers
//   cells          a cell exists iff M_L has triangles below it
//   partition      each triangle of M_L lies in the half-open cell of its barycentre; V_L(C) = vertices of M_L(C)
//   identity       a shared id occurs in two cells or more, once in each; its copies have the same bits; on M_L equal
//                  positions <=> one identity (with wedges: one vertex); an id that two levels have is kept by P
//   parents        P is a function on the vertices of the level: copies of a vertex have one parent
//   vertices       V_{l-1}(C) = P(union of V_l over the children of C), as sets
//   triangles      M_{l-1}(C) = image under P of M_l of the children without degenerate ones, as oriented multisets
//   displacement   (1): d(v, P(v)) <= sigma0 h_l / 2, and the stored maximum of each cell
//   lattice        if the model has a lattice, every vertex of every level is on it
//   edges          stored longest edges and numbers of long half-edges; no long edge where M_L has none, and M_L has
//                  none where edges were split
//   boxes          B(C) is the box of V_l(C) and of the children's B
//   reach          rho_l of both metrics and the largest diameter
//   errors         on M_L the distance by which the lattice may have moved the input (twice that when edges were
//                  split), 0 without one. Estimated: a coarser cell's is at least a child's error + the distance of the
//                  child's vertices from the surface of the coarser level, at most the worst child's error +
//                  displacement. Measured: at least every child's, at least the distances of M_l(C) from M_L and of M_L
//                  below C from M_l at the corners and middles of triangles and edges, at most all displacements
//                  together with the longest edge. Both of a regular sample on large levels. e_l
//   fingerprint    every input triangle is there: number of triangles, of vertices, and fingerprint of M_L
//   signatures     only where the hierarchy has them: copies of a vertex have one, which has all cells that use it
//   wedges         only with attributes: wedges of one vertex of M_L have parents at one position, level by level; the
//                  corners of a triangle have one material, and P keeps it; finite texture coordinates
//   textures       only with copies of textures: each is an image of half the size of the one before, and the mean of
//                  its pixels (of light, or of normals) is that of the texture
//   input          only with `input`: the triangles of M_L are those of the input, position by position, or, where
//                  edges were split, what splitting each of them makes; the input is on the same lattice
// When `structure` fails the others are reported as failed without being run, since no index could be trusted.
//
// Time: about one second per million triangles of M_L at most (by several threads: parallel/hierarchy/verify_threads.h,
// by several processes: parallel/distributed/rank_verify.h); memory: a few words per vertex of two levels, and 24
// bytes per input triangle for `input`.
//
// `progress` gets the share of the steps that are done, in (0, 1], after each of them; what it throws ends the call.
using VerifyProgress = std::function<void(double share)>;
[[nodiscard]] VerifyReport verify_hierarchy(const Hierarchy& hierarchy, const IndexedMesh* input = nullptr,
                                            const VerifyProgress& progress = {});

}  // namespace lodestone
