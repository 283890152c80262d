// Two passes over the cells: pack each from its own triangles, adding up what the cells know of a shared vertex; then
// give every copy of a shared vertex the sum. What several workers add to one place is added with operations that
// commute exactly: minima, maxima, and sums in fixed point.
#include "parallel/finest_level.h"

#include <algorithm>
#include <array>
#include <atomic>

namespace lodestone {
namespace {

constexpr std::size_t cell_grain = 16;

// Sums of vectors whose result does not depend on the order: 64-bit fixed point. Twice a triangle's area is at most 2,
// and 2^54 leaves room for hundreds of such triangles while resolving areas of 1e-16.
class NormalSums {
 public:
  explicit NormalSums(std::size_t count) : sums_(count) {}
  void add(std::size_t i, Float4 n) {
    for (int k = 0; k < 3; ++k)
      std::atomic_ref(sums_[i][static_cast<std::size_t>(k)])
          .fetch_add(static_cast<std::int64_t>(n[k] * scale_), std::memory_order_relaxed);
  }
  [[nodiscard]] Vec3f sum(std::size_t i) const {
    const auto v = [&](std::size_t k) { return static_cast<float>(static_cast<double>(sums_[i][k])); };
    return {v(0), v(1), v(2)};  // the scale does not matter for a direction
  }

 private:
  static constexpr float scale_ = 0x1p54f;
  std::vector<std::array<std::int64_t, 3>> sums_;
};

// UsageBox extended by several workers: lo and hi of an axis in one word each.
class UsageBoxes {
 public:
  explicit UsageBoxes(std::size_t count) : axes_(count, {empty_, empty_, empty_}) {}
  void extend(std::size_t i, CellCoord c) {
    extend_axis(axes_[i][0], c.x);
    extend_axis(axes_[i][1], c.y);
    extend_axis(axes_[i][2], c.z);
  }
  [[nodiscard]] UsageBox box(std::size_t i) const {
    const auto lo = [&](std::size_t k) { return static_cast<std::uint16_t>(axes_[i][k] & 0xffff); };
    const auto hi = [&](std::size_t k) { return static_cast<std::uint16_t>(axes_[i][k] >> 16); };
    return {{lo(0), lo(1), lo(2)}, {hi(0), hi(1), hi(2)}};
  }

 private:
  static void extend_axis(std::uint32_t& word, std::uint32_t v) {
    const std::atomic_ref axis(word);
    std::uint32_t old = axis.load(std::memory_order_relaxed);
    for (;;) {
      const std::uint32_t extended = std::min(old & 0xffff, v) | (std::max(old >> 16, v) << 16);
      if (extended == old || axis.compare_exchange_weak(old, extended, std::memory_order_relaxed)) return;
    }
  }
  static constexpr std::uint32_t empty_ = 0x0000'ffffu;
  std::vector<std::array<std::uint32_t, 3>> axes_;
};

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
