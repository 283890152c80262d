// Pictures: PNG files, contact sheets, and how much two pictures differ.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/camera/projection.h"

namespace lodestone {

struct Image {
  ImageSize size;
  std::vector<std::uint8_t> rgba;  // 4 bytes a pixel, rows from the top
  std::vector<float> depth;        // window depth in [0, 1], 1 = nothing; rows from the top; may be empty
};

// Colour only, 8 bits a channel, no time stamp: equal pictures give equal files, complete or not there. Throws
// InputError for an empty picture, FileError when the file cannot be written.
void write_png(const std::string& file, const Image& image);
// The bytes of such a file.
[[nodiscard]] std::vector<std::byte> encode_png(const Image& image);

// Any PNG, converted to 8-bit RGBA. Throws FileError when it cannot be opened, InputError when it is an invalid PNG.
[[nodiscard]] Image read_png(const std::string& file);

// Box-filtered colour: each new pixel is the mean of the area it covers. No larger than the image in either direction.
// Throws InputError for another size.
[[nodiscard]] Image downscale(const Image& image, ImageSize size);

struct ContactSheetConfig {
  int columns = 0;   // frames in a row; 0: the number that makes the sheet just wider than square; at most the frames
  int width = 1600;  // of the sheet, pixels; frames are only ever scaled down, so that the sheet may be narrower
  int gap = 4;       // pixels between frames and around them
};

// Frames side by side, row by row, scaled down to fit. Throws InputError when there are none, when their sizes differ,
// or when the sheet is too narrow for them.
[[nodiscard]] Image contact_sheet(std::span<const Image> frames, const ContactSheetConfig& config = {});

struct ImageDifference {
  int max = 0;                  // largest difference of a channel, 0-255
  double mean_absolute = 0;     // over all channels, in units of 1/255
  double differing_share = 0;   // share of the pixels with a channel that differs by more than the threshold
  std::uint64_t differing = 0;  // their number
};

// Colour, alpha included. Throws InputError when the sizes differ.
[[nodiscard]] ImageDifference image_difference(const Image& a, const Image& b, int threshold = 8);

}  // namespace lodestone
