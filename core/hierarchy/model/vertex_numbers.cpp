#include "core/hierarchy/model/vertex_numbers.h"

#include <algorithm>
#include <bit>

namespace lodestone {
namespace {

constexpr std::uint32_t no_id = 0xffff'ffffu;

// The slot of this id, or the empty one for it. The processor predicts well that the first slot is one of these, but
// not which, hence one branch for both.
template <class Slot>
inline Slot& find(Slot* slots, std::uint32_t mask, int shift, std::uint32_t id) {
  std::uint32_t i = (id * 0x9e37'79b9u) >> shift;  // Fibonacci hashing
  while ((slots[i].id != id) & (slots[i].id != no_id)) i = (i + 1) & mask;
  return slots[i];
}

}  // namespace

void VertexNumbers::clear(std::size_t triangles) {
  // Half a vertex per triangle, and some for the border.
  resize(std::bit_ceil(std::clamp<std::size_t>(triangles + triangles / 4, 16, std::size_t{1} << 30)));
  count_ = 0;
}

void VertexNumbers::resize(std::size_t slots) {
  if (slots_.size() < slots) slots_.resize(slots);
  std::fill_n(slots_.begin(), slots, Slot{no_id, 0});
  mask_ = static_cast<std::uint32_t>(slots - 1);
  shift_ = 32 - std::countr_zero(slots);
  if (vertices_.size() < slots / 2 + 4) vertices_.resize(slots / 2 + 4);
}

void VertexNumbers::grow() {
  resize(2 * (std::size_t{mask_} + 1));
  for (std::uint32_t n = 0; n < count_; ++n) find(slots_.data(), mask_, shift_, vertices_[n]) = {vertices_[n], n};
}

void VertexNumbers::number(std::span<const Triangle> from, Triangle* to) {
  while (!from.empty()) {
    if (room() == 0) grow();
    const std::size_t now = std::min(from.size(), room());
    number_with_room(from.first(now), to);
    from = from.subspan(now);
    to += now;
  }
}

// Number of triangles with new vertices that leave the table at most half full.
std::size_t VertexNumbers::room() const { return ((std::size_t{mask_} + 1) / 2 - count_) / 3; }

void VertexNumbers::number_with_room(std::span<const Triangle> from, Triangle* to) {
  Slot* const slots = slots_.data();
  std::uint32_t* const vertices = vertices_.data();
  const std::uint32_t mask = mask_;
  const int shift = shift_;
  std::uint32_t count = count_;
  for (const Triangle& triangle : from) {
    Triangle numbered;
    for (std::size_t k = 0; k < 3; ++k) {
      // Every sixth vertex is new, unpredictably: hence without a branch.
      const std::uint32_t id = triangle.v[k];
      Slot& slot = find(slots, mask, shift, id);
      const bool is_new = slot.id != id;
      const std::uint32_t n = is_new ? count : slot.number;
      slot = {id, n};
      vertices[count] = id;
      count += is_new;
      numbered.v[k] = n;
    }
    *to++ = numbered;
  }
  count_ = count;
}

}  // namespace lodestone
