// Small consecutive numbers for the vertices of a cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Numbers vertices in order of first appearance. An open-addressing table of eight bytes a slot that is small enough
// for the first-level cache at the usual size of cells, where a stamp per input vertex would not be. Reused between
// cells; memory: 16 to 32 bytes per vertex of the largest cell.
class VertexNumbers {
 public:
  // Clears the table. `triangles`, their expected number, sizes it for a closed surface; it grows when needed.
  void clear(std::size_t triangles);
  // Copies triangles with the numbers in place of the ids; ids are below 2^32 - 1. `to` may be `from` itself.
  void number(std::span<const Triangle> from, Triangle* to);
  // The ids by number.
  [[nodiscard]] std::span<const std::uint32_t> vertices() const { return std::span(vertices_).first(count_); }

 private:
  struct Slot {
    std::uint32_t id, number;
  };
  void resize(std::size_t slots);
  void grow();
  [[nodiscard]] std::size_t room() const;
  void number_with_room(std::span<const Triangle> from, Triangle* to);

  std::vector<Slot> slots_;              // the first mask_ + 1 are in use
  std::vector<std::uint32_t> vertices_;  // with space for one vertex more than the table
  std::uint32_t count_ = 0, mask_ = 0;
  int shift_ = 0;
};

}  // namespace lodestone
