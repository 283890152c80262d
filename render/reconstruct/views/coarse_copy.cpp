#include "render/reconstruct/views/coarse_copy.h"

#include <cmath>
#include <cstdint>
#include <vector>

namespace lodestone {
namespace {

// Numbers of the cells that points are in, in the order of their first points.
class CellNumbers {
 public:
  explicit CellNumbers(double cell) : scale_(1 / cell) { table_.resize(std::size_t{1} << 16, {0, empty}); }

  std::uint32_t of(Vec3f p) {
    const auto step = [this](float v) { return static_cast<std::uint64_t>(std::floor(v * scale_) + half) & mask; };
    const std::uint64_t key = step(p.x) << 42 | step(p.y) << 21 | step(p.z);
    if (key == last_key_ && count_ > 0) return last_;
    last_key_ = key;
    return last_ = find(key);
  }
  [[nodiscard]] std::uint32_t count() const { return count_; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t number = 0;
  };
  static constexpr std::uint32_t empty = 0xFFFF'FFFFu;
  static constexpr std::uint64_t mask = (std::uint64_t{1} << 21) - 1;
  static constexpr double half = 1 << 20;

  std::uint32_t find(std::uint64_t key) {
    if (2 * std::size_t{count_} >= table_.size()) grow();
    Slot& slot = slot_of(key);
    if (slot.number == empty) slot = {key, count_++};
    return slot.number;
  }
  Slot& slot_of(std::uint64_t key) {
    std::size_t at = static_cast<std::size_t>(key * 0x9E37'79B9'7F4A'7C15u >> 24);
    for (;; ++at) {
      Slot& slot = table_[at & (table_.size() - 1)];
      if (slot.number == empty || slot.key == key) return slot;
    }
  }
  void grow() {
    std::vector<Slot> old(2 * table_.size(), {0, empty});
    old.swap(table_);
    for (const Slot& slot : old)
      if (slot.number != empty) slot_of(slot.key) = slot;
  }

  double scale_;
  std::vector<Slot> table_;  // open addressing, at most half full
  std::uint32_t count_ = 0, last_ = 0;
  std::uint64_t last_key_ = 0;
};

}  // namespace

IndexedMesh coarse_copy(const IndexedMesh& mesh, double cell) {
  CellNumbers cells(cell);
  std::vector<std::uint32_t> number;
  number.reserve(mesh.positions.size());
  std::vector<Vec3d> sums;
  std::vector<std::uint32_t> counts;
  for (const Vec3f& p : mesh.positions) {
    const std::uint32_t own = cells.of(p);
    if (own == sums.size()) sums.emplace_back(), counts.push_back(0);
    sums[own] = sums[own] + to_double(p), ++counts[own];
    number.push_back(own);
  }
  IndexedMesh out;
  out.transform = mesh.transform;
  out.positions.reserve(sums.size());
  for (std::size_t c = 0; c < sums.size(); ++c) out.positions.push_back(to_float((1.0 / counts[c]) * sums[c]));
  for (const Triangle& t : mesh.triangles) {
    const Triangle coarse{{number[t.v[0]], number[t.v[1]], number[t.v[2]]}};
    if (!is_degenerate(coarse)) out.triangles.push_back(coarse);
  }
  return out;
}

}  // namespace lodestone
