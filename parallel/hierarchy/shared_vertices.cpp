#include "parallel/hierarchy/shared_vertices.h"

#include <algorithm>
#include <array>
#include <atomic>

namespace lodestone {
namespace {

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
  [[nodiscard]] const std::array<std::int64_t, 3>& exact(std::size_t i) const { return sums_[i]; }
  void set(std::size_t i, const std::array<std::int64_t, 3>& sum) { sums_[i] = sum; }
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

}  // namespace

class SharedVertices::Sums {
 public:
  explicit Sums(std::size_t count) : boxes(count), normals(count) {}
  UsageBoxes boxes;
  NormalSums normals;
};

SharedVertices::SharedVertices(const FinestVertices& vertices)
    : vertices_(vertices), sums_(std::make_unique<Sums>(vertices.shared)) {}

SharedVertices::~SharedVertices() = default;

void SharedVertices::add(const CellBuild& cell, CellCode code, std::span<const Float4> normals) {
  for (std::size_t k = 0; k < normals.size(); ++k) {
    sums_->boxes.extend(index(cell, k), code.coord());
    sums_->normals.add(index(cell, k), normals[k]);
  }
}

SharedSum SharedVertices::sum(std::size_t number) const {
  return {sums_->boxes.box(number), sums_->normals.exact(number)};
}

void SharedVertices::set_sum(std::size_t number, const SharedSum& sum) {
  sums_->boxes.extend(number, sum.usage.lo);
  sums_->boxes.extend(number, sum.usage.hi);
  sums_->normals.set(number, sum.normal);
}

void SharedVertices::finish(Scheduler& scheduler) {
  constexpr std::size_t grain = 1 << 16;
  usage_.resize(vertices_.shared);
  normals_.resize(vertices_.shared);
  scheduler.for_chunks(vertices_.shared, grain, [&](ChunkRange range) {
    for (std::size_t i = range.begin; i < range.end; ++i) {
      usage_[i] = sums_->boxes.box(i);
      normals_[i] = pack_normal(sums_->normals.sum(i));
    }
  });
  sums_.reset();
}

void SharedVertices::describe(CellBuild& cell) const {
  cell.usage.resize(cell.slab.shared_ids.size());
  for (std::size_t k = 0; k < cell.usage.size(); ++k) {
    cell.usage[k] = usage_[index(cell, k)];
    cell.slab.normals[cell.first_shared() + k] = normals_[index(cell, k)];
  }
}

}  // namespace lodestone
