// A cell above the finest level as bytes, for the rank that runs its block.
#pragma once

#include <span>

#include "core/hierarchy/construct/cell_build.h"
#include "parallel/distributed/messages/transport.h"

namespace lodestone {

// Appends the cell without parents, with all that its block needs.
void append_cell(CellCode code, const CellBuild& cell, Message& message);

// The bytes that it appends for a cell with so many of them.
struct CellCounts {
  std::size_t vertices = 0, shared = 0, triangles = 0;
  AttributeSet attributes{};
};
[[nodiscard]] std::size_t cell_message_bytes(const CellCounts& counts);

// Reads the cells of a message, which all have these attributes, one after the other. Throws Error where the bytes end
// within a cell.
class CellReader {
 public:
  CellReader(const Message& message, const AttributeSet& attributes) : left_(message), attributes_(attributes) {}
  [[nodiscard]] bool at_end() const { return left_.empty(); }
  CellCode read(CellBuild& cell);

 private:
  template <class T>
  void take(std::span<T> to);

  std::span<const std::byte> left_;
  AttributeSet attributes_;
};

}  // namespace lodestone
