// Images between their encoded bytes and pixels: PNG by libpng, JPEG by libjpeg-turbo, WebP by libwebp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lodestone {

struct PixelSize {
  std::uint32_t width = 0, height = 0;
  friend bool operator==(const PixelSize&, const PixelSize&) = default;
};

// Rows from the top, without padding.
struct PixelImage {
  PixelSize size;
  std::uint32_t channels = 3;  // 1: grey, 3: red, green, blue; 4: and alpha
  std::vector<std::uint8_t> pixels;
  int chroma = 0;  // of a JPEG: libjpeg-turbo's number of the chroma subsampling, kept when it is encoded again
  friend bool operator==(const PixelImage&, const PixelImage&) = default;
};

// Sum of the squared differences between the numbers of two images of one size, with as many channels.
[[nodiscard]] std::uint64_t squared_error(const PixelImage& a, const PixelImage& b);

// The same of three channels, as 16-bit numbers that mean no colours: normals, positions.
struct WideImage {
  PixelSize size;
  std::vector<std::uint16_t> values;  // three per pixel
  friend bool operator==(const WideImage&, const WideImage&) = default;
};

// Pixels as they are encoded: in sRGB for colours. 16 bits become 8, palettes become colours. Throws UnsupportedError
// for formats other than image/png, image/jpeg and image/webp, for CMYK JPEG, animated WebP, for more than 2^28 pixels;
// InputError for damaged images. The message does not name the file.
[[nodiscard]] PixelImage decode_image(std::span<const char> bytes, const std::string& media_type);

// Size of the encoded image, from its header. Throws the same.
[[nodiscard]] PixelSize image_size(std::span<const char> bytes, const std::string& media_type);

// The quality of JPEG and WebP, from 1 to 100; WebP of quality 100 is without loss, as PNG of 8 bits always is. Equal
// pixels give equal bytes with one version of the libraries. Throws UnsupportedError for other formats and for WebP of
// more than 16383 pixels a side, ResourceError when the library fails.
[[nodiscard]] std::vector<char> encode_image(const PixelImage& image, const std::string& media_type, int quality = 90);

// PNG of 16 bits per component, without loss and without a colour space. decode_image() rounds the values of such
// a file to 8 bits. decode_wide_png() throws InputError also for a PNG of fewer bits, of grey or with alpha.
[[nodiscard]] std::vector<char> encode_wide_png(const WideImage& image);
[[nodiscard]] WideImage decode_wide_png(std::span<const char> bytes);

}  // namespace lodestone
