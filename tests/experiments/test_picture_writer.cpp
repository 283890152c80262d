// Pictures of a flight on disk: all or none, and each different one encoded once.
#include <gtest/gtest.h>

#include "experiments/command_line/picture_writer.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

class PictureFiles : public FolderTest {
 protected:
  // A picture of 8x6 pixels of one grey.
  static Image grey(std::uint8_t value) {
    return {.size = {8, 6}, .rgba = std::vector<std::uint8_t>(std::size_t{8} * 6 * 4, value), .depth = {}};
  }
  [[nodiscard]] std::string folder() const { return (folder_ / "frames").string(); }
  [[nodiscard]] std::string frame(int number) const {
    return content(folder_ / "frames" / ("frame000" + std::to_string(number) + ".png"));
  }
};

TEST_F(PictureFiles, EqualFramesInARowAreEncodedOnce) {
  PictureWriter writer(folder(), 6);
  std::size_t index = 0;
  for (const std::uint8_t value : std::vector<std::uint8_t>{10, 10, 10, 200, 200, 10}) writer.add(index++, grey(value));
  writer.finish();
  EXPECT_EQ(writer.encoded(), 3u);
  for (int k = 0; k < 6; ++k)
    EXPECT_EQ(read_png(folder() + "/frame000" + std::to_string(k) + ".png").rgba,
              grey(k < 3 || k == 5 ? 10 : 200).rgba);
  EXPECT_EQ(frame(0), frame(2));
  EXPECT_NE(frame(2), frame(3));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "frames" / "contact.png"));
  // Files of their own: who changes one does not change the others.
  EXPECT_EQ(std::filesystem::hard_link_count(folder_ / "frames" / "frame0001.png"), 1u);
}

TEST_F(PictureFiles, AnotherSizeIsAnotherPicture) {
  PictureWriter writer(folder(), 2);
  writer.add(0, grey(7));
  Image turned = grey(7);
  turned.size = {6, 8};
  writer.add(1, std::move(turned));
  EXPECT_EQ(writer.encoded(), 2u);
}

TEST_F(PictureFiles, UnfinishedFlightsLeaveNothing) {
  {
    PictureWriter writer(folder(), 2);
    writer.add(0, grey(7));
    writer.add(1, {});
    EXPECT_TRUE(std::filesystem::exists(folder_ / "frames" / "frame0000.png"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "frames" / "frame0001.png"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder()));
}

}  // namespace
}  // namespace lodestone
