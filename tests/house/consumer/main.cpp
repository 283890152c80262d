// Builds the hierarchy of a small height field, selects the cells for a viewpoint and morphs their vertices.
#include <cmath>
#include <cstdio>

#include "core/math/vec3.h"
#include "lodestone/parallel/hierarchy/build.h"
#include "lodestone/render/lod/morph.h"
#include "lodestone/render/lod/selection.h"

using namespace lodestone;

namespace {

// n x n posts over the unit square, two triangles between four of them.
IndexedMesh height_field(std::uint32_t n) {
  IndexedMesh mesh;
  for (std::uint32_t i = 0; i < n * n; ++i) {
    const float x = static_cast<float>(i % n) / static_cast<float>(n - 1);
    const float y = static_cast<float>(i / n) / static_cast<float>(n - 1);
    mesh.positions.push_back({x, y, 0.1f + 0.1f * std::sin(20 * x) * std::cos(13 * y)});
  }
  for (std::uint32_t i = 0; i + n < n * n; ++i) {
    if (i % n == n - 1) continue;
    mesh.triangles.push_back({{i, i + 1, i + n + 1}});
    mesh.triangles.push_back({{i, i + n + 1, i + n}});
  }
  return mesh;
}

}  // namespace

int main() {
  static_assert(sizeof(OwnVector) == sizeof(double));
  const auto scheduler = make_tbb_scheduler();
  const Hierarchy hierarchy = build_hierarchy(height_field(200), {.finest_level = 4}, *scheduler);
  const Radii radii = make_radii(hierarchy, {.kappa0 = 1.0f});
  const MorphContext context{&hierarchy, &radii, Blend::smoothstep, {0.2f, 0.2f, 0.3f}};
  Selection selection;
  select_cells(hierarchy, radii, context.viewpoint, {}, selection);

  std::size_t triangles = 0, moved = 0;
  for (const SelectedCell& selected : selection.cells) {
    const Cell& cell = hierarchy.cells[selected.cell];
    std::vector<Vec3f> drawn(cell.positions.size());
    morph_cell(context, selected.cell, drawn);
    triangles += cell.triangles.size();
    for (std::size_t i = 0; i < drawn.size(); ++i) moved += drawn[i] == cell.positions[i] ? 0 : 1;
  }
  std::printf("%d levels, %zu cells drawn, %zu triangles, %zu vertices morphed\n", hierarchy.finest() + 1,
              selection.cells.size(), triangles, moved);
  return radii.admissible && triangles > 0 && moved > 0 ? 0 : 1;
}
