// Attributes of a mesh that is dealt out to the ranks: wedges take the place of vertices, as in
// parallel/clean/prepare_wedges.h, and the triangles go by these from then on.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "parallel/distributed/distributed_clean.h"
#include "parallel/distributed/rank_surface.h"
#include "parallel/distributed/route_triangles.h"

namespace lodestone {

// The values of a wedge; those of kinds that the mesh lacks are all the same.
struct WedgeValues {
  std::uint32_t vertex = 0;  // in the clean mesh of all ranks
  std::uint32_t material = 0;
  Rgba8 colour;
  Vec2f uv;
  Vec3f normal;
  friend bool operator==(const WedgeValues&, const WedgeValues&) = default;
};

[[nodiscard]] std::uint64_t hash_of(const WedgeValues& wedge);

struct WedgeSlices {
  SurfaceKinds kinds;                           // materials: only if there is another one than the first
  Slices wedges, vertices;                      // by number of either; wedges: copies for several materials are last
  std::vector<WedgeValues> values;              // by own wedge
  std::shared_ptr<const MeshStream> triangles;  // of the clean mesh, by wedge

  [[nodiscard]] AttributeSet attributes() const { return {true, kinds.uv, kinds.colours, kinds.materials}; }
};

// Welds the wedges of a vertex that have equal values. Every rank has the vertices and wedges that its triangles use in
// its slices: no file is cut. Afterwards the slices of `clean` are those of wedges and of the triangles that are left.
// Memory: 100 bytes per wedge of a share.
[[nodiscard]] WedgeSlices weld_wedges(RankSurface&& surface, const MeshStream& stream, CleanSlices& clean, Ranks& ranks,
                                      Scheduler& scheduler);

// Gives a mesh that was routed by wedges the attributes of these, and finds the vertices that other ranks use.
void attach_wedges(WedgeSlices&& slices, RoutedMesh& routed, Ranks& ranks);

}  // namespace lodestone
