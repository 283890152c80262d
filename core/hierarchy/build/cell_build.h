// A cell while the hierarchy is being built: its final payload, and what only the next coarser level needs to know.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/hierarchy/model/edge_lengths.h"
#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// Bounding box, in cell coordinates of one level, of the cells that use a vertex. Whether a vertex is used outside of a
// block is the question whether this box leaves the block's: that is all that locking needs, and it takes 12 bytes.
//
// After the finest level a copy may know less than the whole truth: what a neighbouring block added by collapses. It
// always knows one cell of every block that uses the vertex beside its own, or learns it when copies are merged, so the
// question is still answered exactly (docs/decisions/0003-usage-boxes.md gives the argument).
struct UsageBox {
  CellCoord lo{0xffff, 0xffff, 0xffff}, hi{0, 0, 0};
  void extend(CellCoord c);
  void extend(const UsageBox& box);
  [[nodiscard]] UsageBox parent() const;  // the same on the next coarser level
  [[nodiscard]] bool inside(const UsageBox& range) const;
};

// One allocation that holds a cell's arrays.
class CellSlab {
 public:
  void allocate(std::size_t vertices, std::size_t shared, std::size_t triangles, const AttributeSet& attributes = {});

  std::span<Vec3f> positions;
  std::span<PackedNormal> normals;
  std::span<std::uint32_t> parents;
  std::span<std::uint32_t> shared_ids;
  std::span<Vec2f> uv;  // these three as the attributes say
  std::span<Rgba8> colours;
  std::span<std::uint32_t> materials;
  std::span<Triangle> triangles;  // empty at the finest level: those live in the partition's array

 private:
  std::unique_ptr<std::byte[]> memory_;
};

// What is known of a cell beside its payload.
struct CellFigures {
  Box3f bounds;
  float max_displacement = 0, error = 0;
  // Contributions to the level's statistics, as ratios to h_l.
  std::array<float, distance_metric_count> reach{};
  float diameter = 0, max_edge = 0;
  std::uint64_t long_edges = 0;
};

struct CellBuild : CellFigures {
  CellSlab slab;
  std::span<Triangle> triangles;   // local ids; in the slab, or in the partition's array
  std::vector<std::uint32_t> ids;  // input vertex that each vertex survives from; released with usage
  // With wedges, the input vertex that each stands at: the first wedge there. Empty otherwise: the same as ids.
  std::vector<std::uint32_t> vertex_ids;
  std::vector<UsageBox> usage;  // of the shared vertices, in the order of shared_ids

  [[nodiscard]] std::size_t vertex_count() const { return slab.positions.size(); }
  [[nodiscard]] std::size_t first_shared() const { return slab.positions.size() - slab.shared_ids.size(); }
  void release_transient();
};

// Lets the cell look at the payload; the root has no parents.
void view_payload(const CellBuild& build, bool has_parents, Cell& cell);

// Brings the triangles of each material together, in the order of the materials and else in the order they have.
void sort_by_material(CellBuild& cell);

// Fills reach and diameter from the positions and the bounds.
void set_box_statistics(CellBuild& cell, int level);
// Fills max_edge and long_edges; `lengths` with the limit sigma0 h_l.
void set_edge_statistics(CellBuild& cell, int level, const EdgeLengths& lengths);
// Both, from the payload and the bounds.
void measure_cell(CellBuild& cell, int level, float sigma0);

}  // namespace lodestone
