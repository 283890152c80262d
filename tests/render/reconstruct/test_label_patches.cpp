// The pieces of several maps: connected triangles, against a flood.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "parallel/scheduler/scheduler.h"
#include "render/reconstruct/merge/label_patches.h"

namespace lodestone::test {
namespace {

TEST(LabelPatches, AreWhatAFloodFinds) {
  std::mt19937 random(5);
  PositionMap map;
  map.view.width = 23, map.view.height = 17;
  MergeView view;
  view.map = &map;
  view.kept.assign(map.view.pixels(), 0);
  for (int y = 0; y + 1 < map.view.height; ++y)
    for (int x = 0; x + 1 < map.view.width; ++x) {
      constexpr std::uint8_t choices[]{
          0, 0, cell_prs, cell_psq, cell_prq, cell_rsq, cell_prs | cell_psq, cell_prq | cell_rsq};
      view.kept[static_cast<std::size_t>(y * map.view.width + x)] = choices[random() % 8];
    }
  const std::vector<MergeView> views{view, view};
  const auto scheduler = make_serial_scheduler();
  const ViewPatches patches = label_patches(views, *scheduler);
  // Triangles with their cells; over shared edges from one to the next.
  std::vector<std::pair<Triangle, std::size_t>> triangles;
  for (std::size_t i = 0; i < view.kept.size(); ++i)
    for_triangles_of_cell(view.kept[i], static_cast<std::uint32_t>(i), 23, [&](auto a, auto b, auto c) {
      triangles.push_back({{{a, b, c}}, i});
    });
  std::vector<int> flood(triangles.size(), -1);
  std::vector<std::uint32_t> sizes;
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (flood[seed] >= 0) continue;
    std::vector<std::size_t> open{seed};
    flood[seed] = static_cast<int>(sizes.size());
    sizes.push_back(0);
    while (!open.empty()) {
      const std::size_t t = open.back();
      open.pop_back();
      ++sizes.back();
      for (std::size_t u = 0; u < triangles.size(); ++u) {
        int common = 0;
        for (const std::uint32_t v : triangles[t].first.v)
          common += static_cast<int>(std::count(triangles[u].first.v.begin(), triangles[u].first.v.end(), v));
        if (flood[u] < 0 && common == 2) flood[u] = flood[seed], open.push_back(u);
      }
    }
  }
  ASSERT_EQ(patches.triangles.size(), 2 * sizes.size());
  std::map<std::uint32_t, int> flood_of;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t label = patches.of_cell[0][triangles[t].second];
    EXPECT_EQ(flood_of.try_emplace(label, flood[t]).first->second, flood[t]);
    EXPECT_EQ(patches.triangles[label], sizes[static_cast<std::size_t>(flood[t])]);
    EXPECT_EQ(patches.of_cell[1][triangles[t].second], label + sizes.size());
  }
  EXPECT_EQ(flood_of.size(), sizes.size());
}

}  // namespace
}  // namespace lodestone::test
