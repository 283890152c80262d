// The attributes of a mesh while it is cleaned and welded (parallel/clean/prepare.h).
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// A value that is not a number counts as not given. Afterwards equal values have equal bits.
void make_finite(RawWedges& wedges);

// Takes the materials from the triangles to their wedges: returns that of each of the `count` wedges. A wedge that
// triangles of several materials use is copied for each of them but the first, after all others: corners, values and
// `count` follow. Wedges of no triangle get any material.
[[nodiscard]] std::vector<std::uint32_t> give_materials(RawWedges& wedges, std::size_t& count);

// Follows the triangles through the cleaning by the wedges of their corners; wedges of one welded vertex with equal
// attributes become one, the first. For a mesh without attributes every call does nothing.
class WedgePreparation {
 public:
  // Is made before the triangles change. Moves the attributes out of `raw`.
  WedgePreparation(RawMesh& raw, Scheduler& scheduler);

  // Removes the wedges' corners of triangles that have become degenerate, before those are removed.
  void compact(const std::vector<Triangle>& triangles);

  // Turns the vertices of the clean mesh into wedges.
  void attach(IndexedMesh& mesh);

 private:
  void place_wedges(const IndexedMesh& mesh);
  void weld();
  [[nodiscard]] std::uint64_t hash_of(std::size_t wedge) const;
  [[nodiscard]] bool equal(std::uint32_t a, std::uint32_t b) const;
  void number();

  Scheduler& scheduler_;
  RawWedges wedges_;
  std::vector<Material> materials_;
  std::vector<Texture> textures_;
  std::size_t count_ = 0;                // of the wedges in the file; 0 without attributes
  std::vector<std::uint32_t> vertex_;    // of each of them in the clean mesh; none: no triangle uses it
  std::vector<std::uint32_t> material_;  // of each; empty where all have the first
  std::vector<std::uint32_t> numbers_;   // of each: its representative, then its number in the result
  std::vector<std::uint32_t> kept_;      // representatives, ascending
};

}  // namespace lodestone
