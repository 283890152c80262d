// Signatures against the definition: sorted copies of shared vertices, one position after the other.
#include <algorithm>
#include <array>
#include <tuple>

#include "core/hierarchy/model/signatures.h"
#include "core/hierarchy/verify/verify_checks.h"

namespace lodestone::verify {
namespace {

struct Copy {
  std::array<float, 3> position;
  CellId cell;
  VertexId vertex;
  std::uint32_t signature = 0;
};

// Those of all positions that meet here.
std::vector<Copy> sorted_copies(const Part& part, int level) {
  const Signatures& signatures = *part.hierarchy.signatures;
  std::vector<Copy> copies;
  part.for_cells(level, [&](CellId c) {
    const Cell& cell = part.hierarchy.cells[c];
    for (std::size_t k = 0; k < cell.shared_ids.size(); ++k) {
      const Vec3f p = cell.positions[cell.first_shared() + k];
      copies.push_back(
          {{p.x, p.y, p.z}, c, VertexId(cell.first_shared() + k), signatures.of(c)[signatures.places(c)[k]]});
    }
  });
  copies = part.sort_out(std::move(copies), [](const Copy& copy) {
    return key_of(Vec3f{copy.position[0], copy.position[1], copy.position[2]});
  });
  std::sort(copies.begin(), copies.end(), [](const Copy& a, const Copy& b) {
    return std::tie(a.position, a.cell, a.vertex) < std::tie(b.position, b.cell, b.vertex);
  });
  return copies;
}

}  // namespace

void check_signatures(const Part& part, Finding& signatures) {
  const Hierarchy& hierarchy = part.hierarchy;
  for (int l = 0; l <= hierarchy.finest(); ++l) {
    const std::vector<Copy> copies = sorted_copies(part, l);
    for (auto first = copies.begin(); first != copies.end();) {
      const auto last = std::find_if(first, copies.end(), [&](const Copy& c) { return c.position != first->position; });
      const auto where = [&] { return place(l, first->cell, first->vertex); };
      const std::span cells = hierarchy.signatures->users(first->signature).cells;
      signatures.require(std::all_of(first, last, [&](const Copy& c) { return c.signature == first->signature; }),
                         [&] { return where() + ": copies with different signatures"; });
      signatures.require(
          std::all_of(first, last,
                      [&](const Copy& c) { return std::binary_search(cells.begin(), cells.end(), c.cell); }),
          [&] { return where() + ": used by a cell that its signature has not"; });
      // Measured errors are bounds of whole cells.
      if (hierarchy.provenance.measured_errors && cells.size() > 1)
        signatures.require(std::all_of(first, last,
                                       [&](const Copy& c) {
                                         return hierarchy.signatures->error(c.signature) >=
                                                hierarchy.cells[c.cell].error;
                                       }),
                           [&] { return where() + ": used by a cell of a larger error than its signature has"; });
      first = last;
    }
  }
}

}  // namespace lodestone::verify
