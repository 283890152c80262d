// Compares the jumps of vertices between two frames with their bound. usage: pops
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main() try {
  const auto scheduler = make_tbb_scheduler();
  Repairs repairs;
  IndexedMesh mesh = prepare_mesh(generate_mesh({Shape::terrain, 200'000, 1}), repairs, *scheduler);
  const Hierarchy model = build_hierarchy(std::move(mesh), {.cell_triangles = 1000}, *scheduler);
  const Radii radii = make_radii(model, {.kappa0 = 2});
  double worst = 0;
  for (const Blend blend : {Blend::smoothstep, Blend::step}) {
    MorphContext before{&model, &radii, blend, {0.5f, 0.5f, 1.2f}};
    Selection selected_before, selected;
    select_cells(model, radii, before.viewpoint, {nullptr, true}, selected_before);
    PopReport largest;
    for (int frame = 1; frame <= 30; ++frame) {
      const MorphContext now{&model, &radii, blend, {0.5f, 0.5f, 1.2f - 0.02f * static_cast<float>(frame)}};
      select_cells(model, radii, now.viewpoint, {nullptr, true}, selected);
      const PopReport report = largest_jump(before, selected_before, now, selected, *scheduler);
      if (report.jump_over_bound > largest.jump_over_bound) largest = report;
      before = now;
      std::swap(selected_before, selected);
    }
    std::printf("%-10s: largest jump %.3g of the model, %.2f of the bound\n", std::string(name_of(blend)).c_str(),
                largest.max_jump, largest.jump_over_bound);
    if (blend == Blend::smoothstep) worst = largest.jump_over_bound;
  }
  return worst <= 1 ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
