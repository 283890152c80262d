// Levels of a progressive mesh, and the geomorphs between two of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone {

// The triangles of a level and the positions of its vertices, normalised.
struct PlacedLevel {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
};

// Finds levels of one progressive mesh, which must outlive it unchanged.
class LevelFinder {
 public:
  explicit LevelFinder(const ProgressiveMesh& mesh);  // about 30 ns per triangle

  // The finest level of at most so many vertices (at least the base): the number of its vertices, all of a group or
  // none. The same by triangles, and the coarsest whose estimated error is at most the one given (normalised); for
  // measured ones see parallel/progressive/level_errors.h.
  [[nodiscard]] std::uint32_t vertices_for(std::uint32_t most_vertices) const;
  [[nodiscard]] std::uint32_t vertices_for_triangles(std::size_t most_triangles) const;
  [[nodiscard]] std::uint32_t vertices_for_error(float error) const;
  [[nodiscard]] std::size_t triangles_of(std::uint32_t vertices) const;
  [[nodiscard]] float error_of(std::uint32_t vertices) const;

  // The triangles of a level of vertices_for() vertices, into the first so many vertices.
  [[nodiscard]] std::vector<Triangle> compute_level(std::uint32_t vertices) const;
  // The same with its vertices where they are best for that level alone (placement.h); those of the finest level remain
  // where they are.
  [[nodiscard]] PlacedLevel placed_level(std::uint32_t vertices) const;
  // The placed level as a mesh of its own, with its attributes, in the space of the model.
  [[nodiscard]] RawMesh level_mesh(std::uint32_t vertices) const;
  // For every vertex of the finer level the vertex of the coarser one that it comes from: itself, if it is there.
  // Vertices that travel from their ancestors' places, normals and texture coordinates to their own make the geomorph.
  [[nodiscard]] std::vector<std::uint32_t> compute_geomorph(std::uint32_t coarse, std::uint32_t fine) const;

 private:
  const ProgressiveMesh* mesh_;
  std::vector<std::uint32_t> groups_, activations_;  // of vertices, of triangles: in ascending order
};

}  // namespace lodestone
