// Looks for cracks exactly: none with admissible radii, some below the border. usage: cracks
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main() try {
  const auto scheduler = make_tbb_scheduler();
  Repairs repairs;
  IndexedMesh mesh = prepare_mesh(generate_mesh({Shape::sphere, 100'000, 1}), repairs, *scheduler);
  const Hierarchy model = build_hierarchy(std::move(mesh), {.cell_triangles = 500}, *scheduler);
  const auto basis = make_crack_basis(model, *scheduler);
  CrackScratch scratch;
  const auto open_edges = [&](const RadiiConfig& config) {
    const Radii radii = make_radii(model, config);
    std::uint64_t open = 0;
    Selection selection;
    for (int frame = 0; frame < 40; ++frame) {
      const Vec3f eye{0.5f, 0.5f, 0.9f + 0.05f * static_cast<float>(frame)};
      select_cells(model, radii, eye, {nullptr, true}, selection);  // all cells, as cracks are looked for in all of it
      open +=
          residual_edges({&model, &radii, Blend::smoothstep, eye}, selection, *basis, *scheduler, scratch).open_edges;
    }
    std::printf("kappa0 %.2f (%s): %llu open edges in 40 frames\n", static_cast<double>(*config.kappa0),
                radii.admissible ? "admissible" : "below the border", static_cast<unsigned long long>(open));
    return open;
  };
  const std::uint64_t per_level = open_edges({.kappa0 = 2});
  const std::uint64_t below = open_edges({.rule = RadiiRule::uniform, .kappa0 = 0.4f});
  return per_level == 0 && below > 0 ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
