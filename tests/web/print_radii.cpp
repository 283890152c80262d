// Prints the radii by cell of a hierarchy, and for cameras that come near it the selection and the lambdas, as JSON:
// the page has to come to the same (test_radii.mjs). usage: print_radii FILE.lode PIXELS
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "parallel/hierarchy/save.h"
#include "render/lod/morph.h"
#include "render/lod/selection.h"

namespace {

using namespace lodestone;
using nlohmann::json;

// From afar to the surface, around it.
Vec3f viewpoint_of(int view) {
  const double t = view / 11.0, far = 0.55 + 4 * (1 - t) * (1 - t);
  return to_float(Vec3d{0.5 + far * std::cos(5 * t), 0.5 + far * std::sin(5 * t), 0.5 + 0.2 * std::sin(9 * t)});
}

json json_of(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint) {
  Selection selection;
  select_cells(hierarchy, radii, viewpoint, {}, selection);
  const MorphContext context{.hierarchy = &hierarchy, .radii = &radii, .blend = Blend::linear, .viewpoint = viewpoint};
  json cells = json::array(), lambdas = json::array();
  for (const SelectedCell& drawn : selection.cells) {
    std::vector<float> of_cell{1};
    if (drawn.level > 0) adaptive_lambdas(context, drawn.cell, of_cell);
    cells.push_back(std::uint32_t{drawn.cell});
    lambdas.push_back(of_cell);
  }
  return {{"viewpoint", {viewpoint.x, viewpoint.y, viewpoint.z}}, {"cells", cells}, {"lambdas", lambdas}};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto scheduler = make_tbb_scheduler(1);
  const Hierarchy hierarchy = load_lode(argv[1], *scheduler);
  const RadiiConfig config{.rule = RadiiRule::adaptive, .pixel_error = std::strtof(argv[2], nullptr)};
  const Radii radii = make_radii(hierarchy, config);
  json views = json::array();
  for (int view = 0; view < 12; ++view) views.push_back(json_of(hierarchy, radii, viewpoint_of(view)));
  std::cout << json{{"height", config.image_height}, {"fov", config.vertical_fov}, {"aspect", config.aspect},
                    {"byCell", radii.by_cell},       {"select", radii.select},     {"views", views}};
  return 0;
}
