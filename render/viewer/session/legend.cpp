#include "render/viewer/session/legend.h"

#include <cstdio>
#include <set>

#include "render/frame/shading.h"
#include "render/viewer/session/band_tint.h"

namespace lodestone::viewer {
namespace {

// Levels of different models share their colours.
Legend levels_of(const Frame& frame) {
  std::set<int> levels;
  for (const ModelFrame& model : frame.models) {
    if (!model.selection) continue;
    for (const SelectedCell& cell : model.selection->cells)
      if (cell.visible) levels.insert(cell.level);
  }
  Legend legend{"level", {}};
  for (const int level : levels) legend.entries.push_back({shading::tint_of(level), std::to_string(level)});
  return legend;
}

Legend overdraw_counts() {
  Legend legend{"triangles over a pixel", {}};
  for (std::uint32_t n = 1; n < shading::overdraw_most; n += 3)
    legend.entries.push_back({shading::overdraw_colour(n), std::to_string(n)});
  const std::uint32_t most = shading::overdraw_most;
  legend.entries.push_back({shading::overdraw_colour(most), std::to_string(most) + " or more"});
  return legend;
}

Legend errors_in(const ErrorRange& range) {
  Legend legend{"stored error", {{error_colour(0), "0, the input"}}};
  if (!(range.most > 0)) return legend;
  const auto add = [&](int step, double error) {
    char label[32];
    std::snprintf(label, sizeof label, "%.2g", error);
    legend.entries.push_back({error_colour(step), label});
  };
  if (!(range.most > range.least))
    add(error_step(range.most, range), range.most);
  else
    for (int step = 1; step <= error_steps; step += 3) add(step, error_of_step(step, range));
  return legend;
}

Legend band_shares() {
  constexpr int steps = 4;
  Legend legend{"share of the finer level", {}};
  for (int k = steps; k >= 0; --k) {
    const float lambda = static_cast<float>(k) / steps;
    const std::string label = k == steps ? "1, the band begins" : k == 0 ? "0, it ends" : "";
    legend.entries.push_back({band_colour(lambda), label});
  }
  return legend;
}

}  // namespace

std::vector<Legend> legends_of(const ViewSettings& settings, const Frame& frame, const ErrorRange& range) {
  if (settings.overdraw) return {overdraw_counts()};
  std::vector<Legend> legends;
  if (settings.errors)
    legends.push_back(errors_in(range));
  else if (settings.tint)
    legends.push_back(levels_of(frame));
  if (settings.band) legends.push_back(band_shares());
  return legends;
}

}  // namespace lodestone::viewer
