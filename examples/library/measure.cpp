// Compares estimated errors of a hierarchy with measured bounds. usage: measure
#include <cmath>
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main() try {
  const auto scheduler = make_tbb_scheduler();
  Repairs repairs;
  const RawMesh raw = generate_mesh({Shape::sphere, 200'000, 1});
  Hierarchy model = build_hierarchy(prepare_mesh(RawMesh(raw), repairs, *scheduler), {}, *scheduler);
  const std::vector<Level> estimated = model.levels;
  const MeasureReport report = measure_errors(model, {}, *scheduler);
  for (int level = 0; level < model.finest(); ++level) {
    const auto l = static_cast<std::size_t>(level);
    const double size = model.transform.scale * std::ldexp(1.0, -level);
    std::printf("level %d: estimated %.3g, at most %.3g\n", level, size * static_cast<double>(estimated[l].error),
                size * static_cast<double>(model.levels[l].error));
  }
  std::printf("%llu cells stopped early\n", static_cast<unsigned long long>(report.stopped));
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
