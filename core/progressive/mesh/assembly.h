// From a sequence of collapses to a progressive mesh.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/progressive/collapse/collapse_kernel.h"
#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone::progressive {

// Collapses in the order in which they happened; parents as in Collapser::parents().
struct CollapseSequence {
  std::vector<CollapseRecord> records;
  std::span<const Id> parents;
  std::size_t base_triangles = 0;  // at least so many must remain: further collapses are undone
};

// The steps, in this order; those with a range may run side by side. Mesh and rings must outlive it. Materials and
// textures are left to the caller.
class Assembly {
 public:
  // `room`: vectors whose memory is reused.
  Assembly(const IndexedMesh& mesh, const RingMesh& rings, CollapseSequence&& sequence, ProgressiveMesh&& room = {});

  void order();
  void number(std::size_t begin, std::size_t end);  // of collapse_count()
  void gather(std::size_t begin, std::size_t end);  // of vertex_count()
  void find_groups();
  void map_triangles(std::size_t begin, std::size_t end);  // of the mesh
  [[nodiscard]] ProgressiveMesh finish();

  [[nodiscard]] std::size_t collapse_count() const { return sequence_.records.size(); }
  [[nodiscard]] std::size_t vertex_count() const { return wedges_.size(); }

 private:
  struct WedgeLists;
  void cut_sequence();
  [[nodiscard]] std::vector<Id> base_order(const std::vector<bool>& gone) const;
  void make_room();

  const IndexedMesh& mesh_;
  const RingMesh& rings_;
  CollapseSequence sequence_;
  std::vector<Id> wedges_, number_;  // of the rings, by new number; the other way
  ProgressiveMesh out_;
  std::vector<std::uint32_t> groups_;
  std::unique_ptr<Triangle[]> mapped_;  // in the order of the mesh
  std::unique_ptr<std::uint32_t[]> activations_;
};

}  // namespace lodestone::progressive
