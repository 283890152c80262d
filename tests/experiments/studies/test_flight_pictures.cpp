// Pictures that a flight leaves: films that play, strips of differences, the worst one.
#include <gtest/gtest.h>
#include <webp/demux.h>

#include <algorithm>
#include <array>
#include <memory>

#include "core/base/error.h"
#include "experiments/studies/film.h"
#include "experiments/studies/flight_pictures.h"
#include "tests/expect_error.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

class FlightPicturesTest : public FolderTest {
 protected:
  [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string bytes(const char* name) const { return content(folder_ / name); }
};

Image flat(ImageSize size, std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  Image image{size, {}, {}};
  for (int i = 0; i < size.width * size.height; ++i) image.rgba.insert(image.rgba.end(), {red, green, blue, 255});
  return image;
}

struct Film {
  ImageSize size;
  unsigned loops = 1;
  std::vector<Image> pictures;
  std::vector<int> ends;  // milliseconds
};

Film read_film(const std::string& bytes) {
  const WebPData data{reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
  const std::unique_ptr<WebPAnimDecoder, decltype(&WebPAnimDecoderDelete)> decoder(WebPAnimDecoderNew(&data, nullptr),
                                                                                   WebPAnimDecoderDelete);
  if (!decoder) throw InputError("not an animated WebP");
  WebPAnimInfo info;
  WebPAnimDecoderGetInfo(decoder.get(), &info);
  Film film{{static_cast<int>(info.canvas_width), static_cast<int>(info.canvas_height)}, info.loop_count, {}, {}};
  std::uint8_t* pixels = nullptr;
  for (int end = 0; WebPAnimDecoderGetNext(decoder.get(), &pixels, &end) != 0;) {
    film.pictures.push_back({film.size, {pixels, pixels + 4 * info.canvas_width * info.canvas_height}, {}});
    film.ends.push_back(end);
  }
  return film;
}

std::array<int, 3> colour(const Image& image, int x, int y) {
  const std::uint8_t* at = &image.rgba[4 * static_cast<std::size_t>(y * image.size.width + x)];
  return {at[0], at[1], at[2]};
}

TEST_F(FlightPicturesTest, AFilmShowsItsPicturesInTheirOrderForever) {
  const std::vector<Image> pictures{flat({40, 24}, 200, 30, 30), flat({40, 24}, 30, 200, 30),
                                    flat({40, 24}, 30, 30, 200)};
  write_film(path("a.webp"), pictures, 50);
  const Film film = read_film(bytes("a.webp"));
  EXPECT_EQ(film.size, (ImageSize{40, 24}));
  EXPECT_EQ(film.loops, 0U) << "no end";
  EXPECT_EQ(film.ends, (std::vector<int>{50, 100, 150}));
  ASSERT_EQ(film.pictures.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(colour(film.pictures[i], 20, 12)[c], colour(pictures[i], 20, 12)[c], 8) << i;
  write_film(path("b.webp"), pictures, 50);
  EXPECT_EQ(bytes("a.webp"), bytes("b.webp"));
}

TEST_F(FlightPicturesTest, RefusesAFilmOfNothingOrOfDifferentSizes) {
  expect_error_of<InputError>([&] { write_film(path("a.webp"), {}, 50); }, {"at least one picture"});
  const std::vector<Image> pictures{flat({8, 8}, 0, 0, 0), flat({8, 9}, 0, 0, 0)};
  expect_error_of<InputError>([&] { write_film(path("a.webp"), pictures, 50); }, {"one size"});
  const std::vector<Image> empty{Image{}};
  expect_error_of<InputError>([&] { write_film(path("a.webp"), empty, 50); }, {"one size"});
  expect_error_of<FileError>([&] { write_film(path("none/a.webp"), std::span(pictures).first(1), 50); },
                             {"none/a.webp"});
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

// One picture in four differs from the full model's: in its right half.
TEST_F(FlightPicturesTest, ShowsEveryPictureBesideItsDifference) {
  const ImageSize size{640, 320};
  const Image full = flat(size, 60, 60, 60);
  Image off = full;
  for (int y = 0; y < size.height; ++y)
    for (int x = size.width / 2; x < size.width; ++x)
      off.rgba[4 * static_cast<std::size_t>(y * size.width + x)] = 60 + 51;
  FlightPictures shown;
  for (int i = 0; i < 12; ++i) shown.offer(i % 4 == 1 ? off : full, full, i % 4 == 1 ? 0.1 : 0);
  shown.write(folder_.string(), *make_serial_scheduler());

  EXPECT_EQ(read_png(path("worst-drawn.png")).rgba, off.rgba);
  EXPECT_EQ(read_png(path("worst-full.png")).rgba, full.rgba);
  const Film film = read_film(bytes("flight.webp"));
  EXPECT_EQ(film.size, (ImageSize{2 * FlightPictures::small_width, 160}));
  // Pictures that are equal one after the other may be one that is shown for longer.
  ASSERT_FALSE(film.ends.empty());
  EXPECT_EQ(film.ends.back(), 12 * 125);
  for (int i = 0; i < 12; ++i) {
    const auto at = std::ranges::upper_bound(film.ends, i * 125) - film.ends.begin();
    const Image& picture = film.pictures[static_cast<std::size_t>(at)];
    const bool differs = i % 4 == 1;
    EXPECT_NEAR(colour(picture, 240, 80)[0], differs ? 111 : 60, 10) << "drawn, " << i;
    EXPECT_NEAR(colour(picture, 80, 80)[0], 60, 10) << "drawn, " << i;
    EXPECT_LT(colour(picture, 320 + 80, 80)[1], 20) << "no difference is black, " << i;
    const int difference = colour(picture, 320 + 240, 80)[1];
    EXPECT_TRUE(differs ? difference > 235 : difference < 20)
        << "the most is white, none black: " << difference << ", " << i;
  }
  // Eight of twelve: 0, 1, 3, 4, 6, 7, 9, 11, of which 1 and 9 differ.
  const Image strip = read_png(path("differences.png"));
  EXPECT_EQ(strip.size.width, 8 * FlightPictures::small_width);
  for (int k = 0; k < 8; ++k)
    EXPECT_EQ(colour(strip, k * FlightPictures::small_width + 240, 80)[1] > 235, k == 1 || k == 6) << k;
}

TEST_F(FlightPicturesTest, OnePictureHasNoFilmAndNoneLeavesNothing) {
  FlightPictures shown;
  shown.write(folder_.string(), *make_serial_scheduler());
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
  shown.offer(flat({32, 16}, 9, 9, 9), flat({32, 16}, 9, 9, 9), 0);
  shown.write(folder_.string(), *make_serial_scheduler());
  EXPECT_TRUE(std::filesystem::exists(path("worst-drawn.png")));
  EXPECT_FALSE(std::filesystem::exists(path("flight.webp")));
  EXPECT_FALSE(std::filesystem::exists(path("differences.png")));
}

}  // namespace
}  // namespace lodestone
