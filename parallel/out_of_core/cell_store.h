// Cells of a hierarchy that is being built, in a scratch file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/files/scratch_file.h"
#include "core/hierarchy/construct/cell_build.h"
#include "core/hierarchy/lode/lode_payload.h"

namespace lodestone {

// The part of a cell in the file that is kept in memory.
struct StoredCell : CellFigures {
  std::uint32_t vertices = 0, shared = 0, triangles = 0;
  std::uint32_t border_errors = 0;  // their number: none on the finest level
  std::uint64_t body = 0;           // offset of what is known when a cell is made
  std::uint64_t parents = 0;        // offset of P of its vertices, known when its block has run
};

[[nodiscard]] PayloadCounts counts_of(const StoredCell& cell, bool has_parents, const AttributeSet& attributes);

// Any number of threads may use it at once, for different cells. The body is the payload but for the parents, then, for
// cells that a block will read, what only blocks know: ids, usage and errors.
class CellStore {
 public:
  CellStore(ScratchFile& file, const AttributeSet& attributes) : file_(file), attributes_(attributes) {}

  void put(const CellBuild& cell, bool for_block, StoredCell& stored);
  void put_parents(const CellBuild& cell, StoredCell& stored);

  // The cell as it was put, without parents.
  void get_for_block(const StoredCell& stored, CellBuild& cell) const;
  // The payload.
  void get_payload(const StoredCell& stored, bool has_parents, CellBuild& cell) const;

  // The positions of the vertices that other cells share, and Cell::border_errors.
  void get_border(const StoredCell& stored, std::vector<Vec3f>& positions, std::vector<float>& errors) const;

  // Bytes of a cell in the file.
  [[nodiscard]] std::uint64_t body_bytes(const StoredCell& cell, bool for_block) const;

 private:
  // Calls visit(array) for the arrays of the body in file order.
  template <class AnyCell, class Visit>
  void visit_body(AnyCell& cell, bool for_block, const Visit& visit) const;
  void get(const StoredCell& stored, bool for_block, CellBuild& cell) const;

  ScratchFile& file_;
  AttributeSet attributes_;
};

}  // namespace lodestone
