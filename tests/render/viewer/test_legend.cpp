// Legends: the meaning of the colours of a picture.
#include <gtest/gtest.h>

#include "render/frame/shading.h"
#include "render/viewer/session/band_tint.h"
#include "render/viewer/session/legend.h"

namespace lodestone::viewer {
namespace {

Frame frame_of(Selection& selection) {
  Frame frame;
  frame.only().selection = &selection;
  return frame;
}

TEST(Legend, OwnColoursNeedNone) {
  Selection selection;
  EXPECT_TRUE(legends_of({}, frame_of(selection)).empty());
}

TEST(Legend, LevelsThatAreSeenAreListedOnce) {
  Selection selection;
  for (const auto& [level, visible] : {std::pair{3, true}, {1, true}, {3, true}, {2, false}, {9, true}})
    selection.cells.push_back({CellId(0), static_cast<std::uint8_t>(level), visible, false});
  ViewSettings settings;
  settings.tint = true;
  const std::vector<Legend> legends = legends_of(settings, frame_of(selection));
  ASSERT_EQ(legends.size(), 1u);
  const std::vector<Legend::Entry> expected{
      {shading::tint_of(1), "1"}, {shading::tint_of(3), "3"}, {shading::tint_of(9), "9"}};
  EXPECT_EQ(legends[0].entries, expected);
}

TEST(Legend, TheBandGoesFromItsBeginToItsEnd) {
  Selection selection;
  ViewSettings settings;
  settings.tint = settings.band = true;
  const std::vector<Legend> legends = legends_of(settings, frame_of(selection));
  ASSERT_EQ(legends.size(), 2u);
  EXPECT_EQ(legends[1].entries.front().colour, band_colour(1));
  EXPECT_EQ(legends[1].entries.back().colour, band_colour(0));
}

TEST(Legend, RadiiOfCellsWhoseBoxesAreShown) {
  Selection selection;
  ViewSettings settings;
  const HeatRange range{0.5, 64};
  EXPECT_TRUE(legends_of(settings, frame_of(selection), {}, range).empty());
  settings.boxes = settings.overdraw = true;
  EXPECT_EQ(legends_of(settings, frame_of(selection)).size(), 1u);  // radii by level
  const Legend legend = legends_of(settings, frame_of(selection), {}, range).back();
  EXPECT_EQ(legend.entries.front().colour, heat_colour(1));
  EXPECT_EQ(legend.entries.back().colour, heat_colour(heat_steps));
}

TEST(Legend, ErrorsReplaceLevels) {
  Selection selection;
  ViewSettings settings;
  settings.tint = settings.errors = true;
  EXPECT_EQ(legends_of(settings, frame_of(selection)).front().entries.size(), 1u);  // no cell has an error
  const HeatRange range{0.001, 10};
  const std::vector<Legend> legends = legends_of(settings, frame_of(selection), range);
  ASSERT_EQ(legends.size(), 1u);
  EXPECT_EQ(legends[0].entries.front().colour, heat_colour(0));
  for (std::size_t k = 1; k < legends[0].entries.size(); ++k)
    EXPECT_EQ(legends[0].entries[k].colour, heat_colour(heat_step(std::stod(legends[0].entries[k].label), range)));
  EXPECT_EQ(legends[0].entries.back().colour, heat_colour(heat_steps));
  const HeatRange single{0.5, 0.5};  // of a model with one coarse cell
  const Legend one = legends_of(settings, frame_of(selection), single).front();
  ASSERT_EQ(one.entries.size(), 2u);
  EXPECT_EQ(one.entries.back().label, "0.5");
  EXPECT_EQ(one.entries.back().colour, heat_colour(heat_step(0.5, single)));
}

TEST(Legend, CountsReplaceAllElse) {
  Selection selection;
  ViewSettings settings;
  settings.tint = settings.band = settings.overdraw = true;
  const std::vector<Legend> legends = legends_of(settings, frame_of(selection));
  ASSERT_EQ(legends.size(), 1u);
  for (const auto& [colour, label] : legends[0].entries)
    EXPECT_EQ(colour, shading::overdraw_colour(static_cast<std::uint32_t>(std::stoul(label))));
  EXPECT_EQ(legends[0].entries.back().label, "16 or more");
}

}  // namespace
}  // namespace lodestone::viewer
