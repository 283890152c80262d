// Hierarchies made the slow, obvious way and open to being broken by hand: an independent twin of the builder.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone::test {

// The data that a cell's spans point at.
struct NaivePayload {
  std::vector<Vec3f> positions;
  std::vector<PackedNormal> normals;
  std::vector<std::uint32_t> parents, shared_ids;
  std::vector<Triangle> triangles;
};

// A hierarchy and the data that it was made from. To break it, change anything in `hierarchy` or `payloads`, then call
// attach(). A copy has payloads of its own.
struct NaiveHierarchy {
  IndexedMesh mesh;
  std::vector<std::vector<std::uint32_t>> ancestors;  // [l][v]: the vertex of the mesh that v has become at level l
  Hierarchy hierarchy;
  std::shared_ptr<std::vector<NaivePayload>> payloads;  // one per cell

  NaiveHierarchy() = default;
  NaiveHierarchy(const NaiveHierarchy& other);
  NaiveHierarchy(NaiveHierarchy&&) = default;
  NaiveHierarchy& operator=(NaiveHierarchy&&) = default;

  // Points the spans at the payloads again; returns the hierarchy.
  const Hierarchy& attach();
};

// The position of a cluster of vertices: that of its vertex of lowest id, or the centre of the cluster's cube, so that
// nearly every vertex moves at every level, some by all that (1) allows.
enum class Representative { vertex, centre };

// P of a level is clustering on a grid of cubes fine enough for (1). Every stored quantity follows its definition, by
// maps and sets; no blocks, no queues, no packing. Finest level L >= 0.
[[nodiscard]] NaiveHierarchy naive_hierarchy(IndexedMesh mesh, int finest, float sigma0 = 0.5f,
                                             Representative representative = Representative::vertex);

}  // namespace lodestone::test
