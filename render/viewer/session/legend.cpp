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

void add_heat(Legend& legend, const HeatRange& range) {
  if (!(range.most > 0)) return;
  const auto add = [&](int step, double figure) {
    char label[32];
    std::snprintf(label, sizeof label, "%.2g", figure);
    legend.entries.push_back({heat_colour(step), label});
  };
  if (!(range.most > range.least))
    add(heat_step(range.most, range), range.most);
  else
    for (int step = 1; step <= heat_steps; step += 3) add(step, heat_of_step(step, range));
}

Legend errors_in(const HeatRange& range) {
  Legend legend{"stored error", {{heat_colour(0), "0, the input"}}};
  add_heat(legend, range);
  return legend;
}

Legend radii_in(const HeatRange& range) {
  Legend legend{"radius of the cell", {}};
  add_heat(legend, range);
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

std::vector<Legend> legends_of(const ViewSettings& settings, const Frame& frame, const HeatRange& errors,
                               const HeatRange& radii) {
  std::vector<Legend> legends;
  if (settings.overdraw)
    legends.push_back(overdraw_counts());
  else if (settings.errors)
    legends.push_back(errors_in(errors));
  else if (settings.tint)
    legends.push_back(levels_of(frame));
  if (settings.band && !settings.overdraw) legends.push_back(band_shares());
  if (settings.boxes && radii.most > 0) legends.push_back(radii_in(radii));
  return legends;
}

}  // namespace lodestone::viewer
