// Two passes over the cells: pack each from its own triangles, adding up what the cells know of a shared vertex; then
// give every copy of a shared vertex the sum. What several workers add to one place is added with operations that
// commute exactly: minima, maxima, and sums in fixed point.
#include "parallel/build/finest_level.h"

#include "parallel/build/shared_vertices.h"

namespace lodestone {
namespace {

constexpr std::size_t cell_grain = 16;

class FinestLevel {
 public:
  FinestLevel(Partition&& partition, Scheduler& scheduler)
      : partition_(std::move(partition)),
        boxes_(partition_.vertices.shared),
        normals_(partition_.vertices.shared),
        scheduler_(scheduler) {}

  void pack_cells(int level, float sigma0) {
    std::vector<FinestCellScratch> scratch(static_cast<std::size_t>(scheduler_.workers()));
    for_cells([&](std::size_t c, CellBuild& cell) {
      const auto worker = static_cast<std::size_t>(scheduler_.worker_index());
      const auto normals = make_finest_cell(partition_.vertices, level, sigma0, cell, scratch[worker]);
      for (std::size_t k = 0; k < normals.size(); ++k) {
        boxes_.extend(shared_index(cell, k), partition_.codes[c].coord());
        normals_.add(shared_index(cell, k), normals[k]);
      }
    });
    std::vector<Vec3f>().swap(partition_.vertices.positions);
  }

  void describe_shared() {
    for_cells([&](std::size_t, CellBuild& cell) {
      cell.usage.resize(cell.slab.shared_ids.size());
      for (std::size_t k = 0; k < cell.usage.size(); ++k) {
        const std::size_t shared = shared_index(cell, k);
        cell.usage[k] = boxes_.box(shared);
        cell.slab.normals[cell.first_shared() + k] = pack_normal(normals_.sum(shared));
      }
      if (partition_.vertices.attributes.wedges) give_attributes(partition_.vertices, cell);
    });
  }

  [[nodiscard]] std::vector<CellBuild> cells() && { return std::move(partition_.cells); }

 private:
  template <class Visit>
  void for_cells(const Visit& visit) {
    scheduler_.for_chunks(partition_.cells.size(), cell_grain, [&](ChunkRange range) {
      for (std::size_t c = range.begin; c < range.end; ++c) visit(c, partition_.cells[c]);
    });
  }
  [[nodiscard]] std::size_t shared_index(const CellBuild& cell, std::size_t k) const {
    return partition_.vertices.sharing[cell.slab.shared_ids[k]] & ~FinestVertices::shared_flag;
  }

  Partition partition_;
  UsageBoxes boxes_;
  NormalSums normals_;
  Scheduler& scheduler_;
};

}  // namespace

std::vector<CellBuild> make_finest_cells(Partition&& partition, int level, float sigma0, Scheduler& scheduler) {
  FinestLevel finest(std::move(partition), scheduler);
  finest.pack_cells(level, sigma0);
  finest.describe_shared();
  return std::move(finest).cells();
}

}  // namespace lodestone
