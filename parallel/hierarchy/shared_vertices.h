// Usage and normals of the vertices that cells of the finest level share: contributions of the cells, added up by
// several workers at once with operations that commute exactly, so that the result does not depend on the order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/hierarchy/construct/cell_build.h"
#include "core/hierarchy/construct/finest_cell.h"
#include "core/math/lanes/float4.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Contributions of some cells to a vertex that they share. Sums do not depend on the order.
struct SharedSum {
  UsageBox usage;
  std::array<std::int64_t, 3> normal{};  // in fixed point

  void add(const SharedSum& more) {
    usage.extend(more.usage);
    for (std::size_t k = 0; k < 3; ++k) normal[k] += more.normal[k];
  }
};

// Memory: 52 bytes per shared vertex at the peak, 16 after finish().
class SharedVertices {
 public:
  static constexpr std::uint64_t peak_bytes_per_vertex = 52, bytes_per_vertex = 16;

  // vertices.sharing is numbered (number_shared) and remains as it is.
  explicit SharedVertices(const FinestVertices& vertices);
  ~SharedVertices();

  // Adds a cell, packed by make_finest_cell, and what that returned. From any thread.
  void add(const CellBuild& cell, CellCode code, std::span<const Float4> normals);
  // The contributions of the cells added so far to a shared vertex, by its number; those of others may be added.
  [[nodiscard]] SharedSum sum(std::size_t number) const;
  void set_sum(std::size_t number, const SharedSum& sum);
  // After all cells were added.
  void finish(Scheduler& scheduler);
  // Gives the cell usage and normals of its shared vertices.
  void describe(CellBuild& cell) const;

 private:
  class Sums;
  [[nodiscard]] std::size_t index(const CellBuild& cell, std::size_t k) const {
    return vertices_.sharing[cell.slab.shared_ids[k]] & ~FinestVertices::shared_flag;
  }

  const FinestVertices& vertices_;
  std::unique_ptr<Sums> sums_;
  std::vector<UsageBox> usage_;        // by number among the shared vertices
  std::vector<PackedNormal> normals_;  // likewise
};

}  // namespace lodestone
