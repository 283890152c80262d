// A hierarchy may be verified by several processes, its peers, each the cells whose payloads it has.
#pragma once

#include <cstddef>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/hierarchy/verify/verify.h"

namespace lodestone {

class VerifyPeers {
 public:
  using Bytes = std::vector<std::byte>;
  virtual ~VerifyPeers() = default;
  [[nodiscard]] virtual std::size_t count() const = 0;
  [[nodiscard]] virtual std::size_t index() const = 0;  // of this one
  // The one that verifies the cell: it has the payloads of the cell, its parent and its siblings. The root has one,
  // too.
  [[nodiscard]] virtual std::size_t owner(CellId cell) const = 0;
  // A call that all make together: out[i] goes to peer i; returns what each has sent to this one.
  [[nodiscard]] virtual std::vector<Bytes> exchange(std::vector<Bytes>&& out) = 0;
};

// verify_hierarchy by all peers together; each returns the report on all cells. The hierarchy has the tables of all,
// and arrays as long as theirs are, but only those of the peer's own cells and of their parents are read; with `input`,
// which then all peers give, those of all finest cells.
[[nodiscard]] VerifyReport verify_by_peers(const Hierarchy& hierarchy, VerifyPeers& peers,
                                           const IndexedMesh* input = nullptr, const VerifyProgress& progress = {});

}  // namespace lodestone
