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

// A cell is any number below `unowned`. False if another one was faster to take the vertex, which seemed to be unowned.
inline bool take_vertex(std::uint32_t& owner, std::uint32_t cell) {
  std::uint32_t expected = unowned;
  return std::atomic_ref(owner).compare_exchange_strong(expected, cell, std::memory_order_relaxed);
}

inline void flag_shared(std::uint32_t& owner) {
  const std::atomic_ref word(owner);
  if (!(word.load(std::memory_order_relaxed) & FinestVertices::shared_flag))
    word.fetch_or(FinestVertices::shared_flag, std::memory_order_relaxed);
}

// Remembers the first cell that claims a vertex, flags the vertex when another one does. The flag does not depend on
// which came first.
inline void claim_vertex(std::uint32_t& owner, std::uint32_t cell) {
  const std::uint32_t old = std::atomic_ref(owner).load(std::memory_order_relaxed);
  if ((old & ~FinestVertices::shared_flag) == cell || (old == unowned && take_vertex(owner, cell))) return;
  flag_shared(owner);
}

// Replaces the owners of shared vertices by consecutive indices in vertex order; returns their number.
[[nodiscard]] std::size_t number_shared(std::span<std::uint32_t> sharing, Scheduler& scheduler);

}  // namespace lodestone
