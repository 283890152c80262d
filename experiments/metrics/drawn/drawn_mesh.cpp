#include "experiments/metrics/drawn/drawn_mesh.h"

#include <limits>
#include <span>

#include "core/base/error.h"

namespace lodestone {
namespace {

void append(std::span<const Vec3f> positions, const Triangles& triangles, DrawnMesh& to) {
  if (to.positions.size() + positions.size() > std::numeric_limits<std::uint32_t>::max())
    throw ResourceError("the drawn cells have more than 2^32 vertices; measure a coarser view");
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  for (const Vec3f p : positions) to.positions.push_back(to_double(p));
  for (const Triangle& t : triangles) to.triangles.push_back({{first + t.v[0], first + t.v[1], first + t.v[2]}});
}

}  // namespace

DrawnMesh drawn_mesh(const MorphContext& context, const Selection& selection) {
  DrawnMesh mesh;
  std::vector<Vec3f> morphed;
  for (const SelectedCell& s : selection.cells) {
    const Cell& cell = context.hierarchy->cells[s.cell];
    morphed.resize(cell.positions.size());
    morph_cell(context, s.cell, morphed);
    append(morphed, cell.triangles, mesh);
  }
  return mesh;
}

DrawnMesh finest_mesh(const Hierarchy& hierarchy) {
  DrawnMesh mesh;
  for (const Cell& cell : hierarchy.cells_of(hierarchy.finest())) append(cell.positions, cell.triangles, mesh);
  return mesh;
}

}  // namespace lodestone
