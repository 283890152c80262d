// A cell while the hierarchy is being built: its final payload, and data that only the next coarser level needs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/math/lanes/float4.h"

namespace lodestone {

// Bounding box, in cell coordinates of one grid, of the cells that use a vertex. A vertex is used outside a block if
// and only if this box leaves that of the block: locking needs nothing else, and it takes 12 bytes.
//
// Above the finest level the box of a copy may lack cells that a neighbouring block added by collapses. It always has
// one cell of every other block that uses the vertex, or gets it when copies are merged, so that the test remains exact
// (docs/decisions/0003-usage-boxes.md gives the argument).
struct UsageBox {
  CellCoord lo{0xffff, 0xffff, 0xffff}, hi{0, 0, 0};
  void extend(CellCoord c);
  void extend(const UsageBox& box);
  [[nodiscard]] UsageBox parent() const;  // the same in the next coarser grid
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
  std::span<Vec2f> uv;  // these three only if the attributes have them
  std::span<Rgba8> colours;
  std::span<std::uint32_t> materials;
  std::span<Triangle> triangles;  // empty at the finest level: they are in the partition's array

 private:
  std::unique_ptr<std::byte[]> memory_;
};

// The longest edge of a cell and the number of half-edges beyond a limit, triangle by triangle.
class EdgeLengths {
 public:
  explicit EdgeLengths(float limit) : limit2_(all4(limit * limit)) {}

  // The three edges of a triangle as vectors, of either direction.
  void add(Float4 ab, Float4 bc, Float4 ca) {
    const Float4 length2 = squared_lengths(ab, bc, ca);
    longest2_ = max(length2, longest2_);
    over_ -= length2 > limit2_;  // -1 in every lane where it is true
  }
  [[nodiscard]] float longest2() const { return std::max({longest2_[0], longest2_[1], longest2_[2]}); }
  // The number of half-edges beyond the limit, for at most 2^32 - 1 triangles.
  [[nodiscard]] std::uint64_t over() const {
    std::uint64_t sum = 0;
    for (int k = 0; k < 3; ++k) sum += static_cast<std::uint32_t>(over_[k]);
    return sum;
  }

 private:
  Float4 limit2_, longest2_{};
  Int4 over_{};
};

// The figures of a cell beside its payload.
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
  // With wedges, the input vertex of each: the first wedge there. Empty otherwise: the same as ids.
  std::vector<std::uint32_t> vertex_ids;
  std::vector<UsageBox> usage;  // of the shared vertices, in the order of shared_ids
  // By vertex: the error of the vertices below that it stands for, as `error` is that of all. Empty on the finest
  // level, where all have the cell's.
  std::vector<float> vertex_errors;
  std::vector<float> border_errors;  // as Cell has them

  [[nodiscard]] std::size_t vertex_count() const { return slab.positions.size(); }
  [[nodiscard]] std::size_t first_shared() const { return slab.positions.size() - slab.shared_ids.size(); }
  void release_transient();
};

// Sets the spans of the cell to the payload; the root has no parents.
void view_payload(const CellBuild& build, bool has_parents, Cell& cell);

// Sorts the triangles by material and otherwise keeps their order.
void sort_by_material(CellBuild& cell);

// Fills reach and diameter from the positions and the bounds.
void set_box_statistics(CellBuild& cell, int grid);
// Fills max_edge and long_edges; `lengths` has the limit sigma0 h_l.
void set_edge_statistics(CellBuild& cell, int grid, const EdgeLengths& lengths);
// Both, from the payload and the bounds. `normals`, one of each vertex, or empty: the cross products of the triangles
// at the vertex are added to it, their components in the order z, x, y, and behind them their lengths.
void measure_cell(CellBuild& cell, int grid, float sigma0, std::span<Float4> normals = {});

}  // namespace lodestone
