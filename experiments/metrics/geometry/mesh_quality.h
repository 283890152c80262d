// Properties of a triangle mesh that do not depend on its place: slivers, borders, manifoldness.
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

struct MeshQuality {
  std::uint64_t triangles = 0, vertices = 0;  // vertices that triangles use
  std::uint64_t slivers = 0;                  // triangles whose longest edge is more than 20 times the height above it
  double worst_aspect = 0;                    // of the triangles with an area; 0 without any
  std::uint64_t no_area = 0;                  // counted among the slivers, too
  std::uint64_t border_edges = 0, non_manifold_edges = 0, inconsistent_edges = 0;  // as EdgeCensus counts them
  std::uint64_t non_manifold_vertices = 0;                                         // their triangles are not one fan
  double border_length = 0;                                                        // in the units of the positions
  std::uint64_t components = 0;
  std::int64_t euler = 0;  // vertices - edges + triangles

  [[nodiscard]] bool manifold() const {
    return non_manifold_edges == 0 && non_manifold_vertices == 0 && inconsistent_edges == 0;
  }
  [[nodiscard]] bool closed() const { return triangles > 0 && border_edges == 0; }
  [[nodiscard]] double sliver_share() const {
    return triangles == 0 ? 0 : static_cast<double>(slivers) / static_cast<double>(triangles);
  }
};

inline constexpr double sliver_aspect = 20;

// Corners that are the same vertex have the same id. Degenerate triangles are left out.
[[nodiscard]] MeshQuality measure_quality(std::span<const Vec3d> positions, std::span<const Triangle> triangles);

}  // namespace lodestone
