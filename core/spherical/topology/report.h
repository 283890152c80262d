// Configuration and report of making spheres of a surface.
#pragma once

#include <cstdint>

namespace lodestone::spherical {

struct ManifoldRepairs {
  std::uint64_t turned_triangles = 0;   // to agree with their neighbours: the fewer of each patch
  std::uint64_t nonmanifold_edges = 0;  // of three triangles or more: cut, with triangles paired by angle
  std::uint64_t clashing_edges = 0;     // cut where a patch has only one side, as a Moebius strip
  std::uint64_t pinched_vertices = 0;   // of the input, which have several fans of triangles
  std::uint64_t vertex_copies = 0;      // that those got: one for each further fan
  std::uint64_t split_edges = 0;        // halved, as others had the same two ends after the cuts
  friend bool operator==(const ManifoldRepairs&, const ManifoldRepairs&) = default;
};

struct HandleConfig {
  // Distance of a loop from the centre of the nearest ball, as a share of the ball's radius, 0 to 1. With 0 balls grow
  // from every seed and each loop is the shortest one. With 0.5 it takes up to fifty times less where loops are
  // long, and they are 0 to 1.5 % longer altogether.
  double slack = 0.5;
};

// Lengths in model units; all zero without loops.
struct LoopLengths {
  double least = 0, mean = 0, greatest = 0, total = 0;
};

// Counts of what was changed; all zero, with one component, for a mesh that was a sphere.
struct TopologyReport {
  ManifoldRepairs manifold;
  std::uint64_t components = 0;
  std::uint64_t boundary_loops = 0;  // filled
  std::uint64_t fill_triangles = 0;
  std::uint64_t handles = 0;         // closed
  std::uint64_t greatest_genus = 0;  // of a component, before
  std::uint64_t cap_triangles = 0;   // of both sides of the cuts
  LoopLengths loops;                 // that the handles were cut along
};

}  // namespace lodestone::spherical
