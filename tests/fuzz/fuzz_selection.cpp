// Selection: whatever the viewpoint and the radii, the drawn cells cover each finest cell exactly once, and neighbours
// of admissible radii differ by a level at most; or the parameters are refused with an Error.
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "core/base/error.h"
#include "core/mesh/clean.h"
#include "core/mesh/generate.h"
#include "parallel/hierarchy/build.h"
#include "render/lod/selection.h"

namespace {
using namespace lodestone;

Hierarchy example(Shape shape) {
  Repairs repairs;
  BuildConfig config;
  config.finest_level = 3;
  return build_hierarchy(clean_mesh(generate_mesh({.shape = shape, .triangles = 2000}), repairs), config,
                         *make_serial_scheduler());
}

void check(const Hierarchy& hierarchy, const Selection& selection) {
  std::vector<int> covered(hierarchy.cells.size());
  for (const SelectedCell& selected : selection.cells) ++covered[selected.cell];
  for (CellId cell = CellId(0); cell < CellId(hierarchy.cells.size()); ++cell)  // parents come before children
    if (hierarchy.cells[cell].parent != no_cell) covered[cell] += covered[hierarchy.cells[cell].parent];
  const Level& finest = hierarchy.levels.back();
  for (std::uint32_t k = 0; k < finest.cell_count; ++k)
    if (covered[finest.first_cell + k] != 1) std::abort();
}
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Hierarchy models[] = {example(Shape::sphere), example(Shape::terrain)};
  float f[16]{};
  if (size < 4) return 0;
  std::memcpy(f, data + 4, std::min(size - 4, sizeof(f)));
  RadiiConfig config;
  config.rule = data[0] & 1 ? RadiiRule::uniform : data[0] & 64 ? RadiiRule::adaptive : RadiiRule::per_level;
  config.metric = data[0] & 2 ? DistanceMetric::chebyshev : DistanceMetric::euclidean;
  if (data[0] & 4 || config.rule == RadiiRule::uniform) config.kappa0 = f[3];
  if (data[0] & 8) config.pixel_error = f[4], config.vertical_fov = f[5], config.aspect = f[6];
  if (data[0] & 16) config.beta = f[7], config.delta = f[8];
  config.image_height = data[2] * 16;
  const Hierarchy& model = models[data[1] & 1];
  try {
    const Radii radii = make_radii(model, config);
    const DetailLimit limit{model.cells[CellId(data[3] % model.cells.size())].bounds, f[9]};
    Selection selection;
    select_cells(model, radii, {f[0], f[1], f[2]}, {.limits = {&limit, data[0] & 32 ? 1u : 0u}}, selection);
    check(model, selection);
  } catch (const Error&) {
  }
  return 0;
}
