// Finds the vertices that several cells of the finest level use, by claims in a word per vertex.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/hierarchy/construct/finest_cell.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

inline constexpr std::uint32_t unowned = 0x7fff'ffffu;  // the word of a vertex before any claim

// Remembers the first cell that claims a vertex, flags the vertex when another one does; cells are any distinct numbers
// below `unowned`. The flag does not depend on which came first.
inline void claim_vertex(std::uint32_t& owner, std::uint32_t cell) {
  const std::atomic_ref word(owner);
  std::uint32_t old = word.load(std::memory_order_relaxed);
  while (old != cell && !(old & FinestVertices::shared_flag)) {
    const std::uint32_t claimed = old == unowned ? cell : old | FinestVertices::shared_flag;
    if (word.compare_exchange_weak(old, claimed, std::memory_order_relaxed)) return;
  }
}

// Replaces the owners of shared vertices by consecutive indices in vertex order; returns their number.
[[nodiscard]] std::size_t number_shared(std::span<std::uint32_t> sharing, Scheduler& scheduler);

}  // namespace lodestone
