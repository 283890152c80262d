// From a sequence of collapses to a progressive mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/progressive/collapse/collapse_kernel.h"
#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone::progressive {

// Collapses in the order in which they happened; parents as in Collapser::parents().
struct CollapseSequence {
  std::vector<CollapseRecord> records;
  std::vector<Id> parents;
  std::size_t base_triangles = 0;  // at least so many must remain: further collapses are undone
};

// The steps, in this order; those with a range may run side by side. Mesh and rings must outlive it; after order() the
// rings may be freed. Materials and textures are left to the caller.
class Assembly {
 public:
  Assembly(const IndexedMesh& mesh, const RingMesh& rings, CollapseSequence&& sequence);

  void order();
  // `room`: positions, parents and triangles whose memory is reused.
  void make_room(ProgressiveMesh&& room = {});
  void number(std::size_t begin, std::size_t end);  // of collapse_count()
  void gather(std::size_t begin, std::size_t end);  // of vertex_count()
  void find_groups();
  void find_ancestors(std::size_t begin, std::size_t end);  // of rings_count()
  void map_triangles(std::size_t begin, std::size_t end);   // of the mesh
  [[nodiscard]] ProgressiveMesh finish();

  [[nodiscard]] std::size_t collapse_count() const { return sequence_.records.size(); }
  [[nodiscard]] std::size_t vertex_count() const { return wedges_.size(); }
  [[nodiscard]] std::size_t rings_count() const { return number_.size(); }

 private:
  struct WedgeLists;
  // A wedge of the rings has its group in the upper half and the wedge that it collapsed into in the lower: in one
  // number, so that they are put in order without a branch.
  using Ancestor = std::uint64_t;
  void cut_sequence();
  [[nodiscard]] std::vector<Id> base_order(const std::vector<bool>& gone) const;
  [[nodiscard]] Id activation_of(const Triangle& corners) const;

  const IndexedMesh& mesh_;
  const RingMesh& rings_;
  CollapseSequence sequence_;
  std::vector<Id> wedges_, number_;  // of the rings, by new number; the other way
  ProgressiveMesh out_;
  std::vector<std::uint32_t> groups_;
  std::unique_ptr<Ancestor[]> ancestors_;
  std::unique_ptr<Triangle[]> mapped_;  // in the order of the mesh
  std::unique_ptr<std::uint32_t[]> activations_;
};

}  // namespace lodestone::progressive
