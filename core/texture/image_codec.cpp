#include "core/texture/image_codec.h"

#include <png.h>
#include <turbojpeg.h>
#include <webp/decode.h>
#include <webp/encode.h>

#include <algorithm>
#include <memory>
#include <string_view>

#include "core/base/error.h"

namespace lodestone {
namespace {

constexpr std::uint64_t max_pixels = std::uint64_t{1} << 28;

void require_size(PixelSize size) {
  if (size.width == 0 || size.height == 0) throw InputError("has no pixels");
  if (std::uint64_t{size.width} * size.height > max_pixels)
    throw UnsupportedError("has " + std::to_string(size.width) + " x " + std::to_string(size.height) + " pixels");
}

[[noreturn]] void refuse_type(const std::string& media_type) {
  throw UnsupportedError("is of type " + media_type + ", which this program does not decode");
}

// PNG, by the simplified interface of libpng, which does not use longjmp.

struct PngImage {
  PngImage() { header.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&header); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
  png_image header{};
};

void open_png(PngImage& png, std::span<const char> bytes) {
  if (png_image_begin_read_from_memory(&png.header, bytes.data(), bytes.size()) == 0)
    throw InputError(std::string("is not a valid PNG image: ") + png.header.message);
  png.header.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
  require_size({png.header.width, png.header.height});
}

png_uint_32 png_format(std::uint32_t channels) {
  return channels == 1 ? PNG_FORMAT_GRAY : channels == 3 ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
}

void read_png(PngImage& png, void* pixels) {
  if (png_image_finish_read(&png.header, nullptr, pixels, 0, nullptr) == 0)
    throw InputError(std::string("is not a valid PNG image: ") + png.header.message);
}

PixelImage decode_png(std::span<const char> bytes) {
  PngImage png;
  open_png(png, bytes);
  PixelImage image{.size = {png.header.width, png.header.height}, .pixels = {}};
  image.channels = png.header.format & PNG_FORMAT_FLAG_ALPHA ? 4 : png.header.format & PNG_FORMAT_FLAG_COLOR ? 3 : 1;
  png.header.format = png_format(image.channels);
  image.pixels.resize(PNG_IMAGE_SIZE(png.header));
  read_png(png, image.pixels.data());
  return image;
}

std::vector<char> write_png(PngImage& png, const void* pixels) {
  std::vector<char> bytes(PNG_IMAGE_PNG_SIZE_MAX(png.header));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&png.header, bytes.data(), &size, 0, pixels, 0, nullptr) == 0)
    throw ResourceError(std::string("cannot be encoded: ") + png.header.message);
  bytes.resize(size);
  return bytes;
}

std::vector<char> encode_png(const PixelImage& image) {
  PngImage png;
  png.header.width = image.size.width;
  png.header.height = image.size.height;
  png.header.format = png_format(image.channels);
  return write_png(png, image.pixels.data());
}

// The interface takes 16 bits for light, which needs no conversion, and says so in a chunk after that of the header.
// Readers would convert the values to sRGB: the chunk is cut out.
void remove_gamma(std::vector<char>& png) {
  constexpr std::ptrdiff_t after_header = 33, length = 16;
  constexpr std::string_view name = "gAMA";
  const auto chunk = png.begin() + after_header;
  if (std::equal(name.begin(), name.end(), chunk + 4)) png.erase(chunk, chunk + length);
}

// JPEG, by the slow exact transform: its bytes are the same with and without SIMD.

using TurboHandle = std::unique_ptr<void, int (*)(tjhandle)>;

struct JpegHeader {
  PixelSize size;
  int chroma = 0, colours = 0;
};

JpegHeader read_jpeg_header(tjhandle turbo, std::span<const char> bytes) {
  JpegHeader header;
  int width = 0, height = 0;
  if (turbo == nullptr || tjDecompressHeader3(turbo, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                                              &width, &height, &header.chroma, &header.colours) != 0)
    throw InputError(std::string("is not a valid JPEG image: ") + tjGetErrorStr2(turbo));
  header.size = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
  require_size(header.size);
  if (header.colours == TJCS_CMYK || header.colours == TJCS_YCCK) throw UnsupportedError("is a CMYK JPEG image");
  return header;
}

PixelImage decode_jpeg(std::span<const char> bytes) {
  const TurboHandle turbo(tjInitDecompress(), tjDestroy);
  const JpegHeader header = read_jpeg_header(turbo.get(), bytes);
  PixelImage image{.size = header.size, .pixels = {}, .chroma = header.chroma};
  image.channels = header.colours == TJCS_GRAY ? 1 : 3;
  image.pixels.resize(std::size_t{image.size.width} * image.size.height * image.channels);
  if (tjDecompress2(turbo.get(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                    image.pixels.data(), static_cast<int>(image.size.width), 0, static_cast<int>(image.size.height),
                    image.channels == 1 ? TJPF_GRAY : TJPF_RGB, TJFLAG_ACCURATEDCT) != 0 &&
      tjGetErrorCode(turbo.get()) != TJERR_WARNING)
    throw InputError(std::string("is not a valid JPEG image: ") + tjGetErrorStr2(turbo.get()));
  return image;
}

// Progressive: the same pixels in 2 to 35 % fewer bytes.
std::vector<char> encode_jpeg(const PixelImage& image, int quality) {
  const TurboHandle turbo(tjInitCompress(), tjDestroy);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int chroma = image.channels == 1 ? TJSAMP_GRAY : image.chroma == TJSAMP_GRAY ? TJSAMP_444 : image.chroma;
  const int failed =
      turbo == nullptr || tjCompress2(turbo.get(), image.pixels.data(), static_cast<int>(image.size.width), 0,
                                      static_cast<int>(image.size.height),
                                      image.channels == 1   ? TJPF_GRAY
                                      : image.channels == 3 ? TJPF_RGB
                                                            : TJPF_RGBX,
                                      &bytes, &size, chroma, quality, TJFLAG_ACCURATEDCT | TJFLAG_PROGRESSIVE) != 0;
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owned(bytes, tjFree);
  if (failed) throw ResourceError(std::string("cannot be encoded: ") + tjGetErrorStr2(turbo.get()));
  return {bytes, bytes + size};
}

// WebP.

struct WebpHeader {
  PixelSize size;
  bool alpha = false;
};

WebpHeader read_webp_header(std::span<const char> bytes) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), &features) != VP8_STATUS_OK)
    throw InputError("is not a valid WebP image");
  if (features.has_animation != 0) throw UnsupportedError("is an animated WebP image");
  const WebpHeader header{{static_cast<std::uint32_t>(features.width), static_cast<std::uint32_t>(features.height)},
                          features.has_alpha != 0};
  require_size(header.size);
  return header;
}

PixelImage decode_webp(std::span<const char> bytes) {
  const WebpHeader header = read_webp_header(bytes);
  PixelImage image{.size = header.size, .channels = header.alpha ? 4u : 3u, .pixels = {}};
  image.pixels.resize(std::size_t{image.size.width} * image.size.height * image.channels);
  const auto* const data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  const int stride = static_cast<int>(image.size.width * image.channels);
  const auto decode = header.alpha ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
  if (decode(data, bytes.size(), image.pixels.data(), image.pixels.size(), stride) == nullptr)
    throw InputError("is not a valid WebP image");
  return image;
}

// WebP knows no grey.
PixelImage three_channels(const PixelImage& image) {
  PixelImage out{.size = image.size, .channels = 3, .pixels = {}};
  out.pixels.reserve(3 * image.pixels.size());
  for (const std::uint8_t x : image.pixels) out.pixels.insert(out.pixels.end(), 3, x);
  return out;
}

// The image has 3 or 4 channels.
std::vector<char> run_webp(const PixelImage& image, const WebPConfig& config) {
  WebPPicture picture;
  if (WebPPictureInit(&picture) == 0) throw ResourceError("cannot be encoded: another version of libwebp");
  picture.use_argb = 1;
  picture.width = static_cast<int>(image.size.width);
  picture.height = static_cast<int>(image.size.height);
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  const auto import = image.channels == 4 ? WebPPictureImportRGBA : WebPPictureImportRGB;
  const bool good = import(&picture, image.pixels.data(), static_cast<int>(image.channels * image.size.width)) != 0 &&
                    WebPEncode(&config, &picture) != 0;
  std::vector<char> bytes(writer.mem, writer.mem + writer.size);
  const int fault = picture.error_code;
  WebPPictureFree(&picture);
  WebPMemoryWriterClear(&writer);
  if (!good) throw ResourceError("cannot be encoded: libwebp reports error " + std::to_string(fault));
  return bytes;
}

// Every so many bands of as many rows as WebP's blocks have.
PixelImage some_bands(const PixelImage& image) {
  constexpr std::size_t band = 16, distance = 8;
  const std::size_t row = std::size_t{image.channels} * image.size.width, bands = image.size.height / band;
  if (bands < 2 * distance) return image;
  PixelImage out{.size = {image.size.width, 0}, .channels = image.channels, .pixels = {}};
  for (std::size_t b = distance / 2; b < bands; b += distance, out.size.height += band) {
    const auto from = image.pixels.begin() + static_cast<std::ptrdiff_t>(b * band * row);
    out.pixels.insert(out.pixels.end(), from, from + static_cast<std::ptrdiff_t>(band * row));
  }
  return out;
}

// The settings for measures: the least error, rather than one that eyes forgive. Smoothing blocks makes smooth images
// better by up to 1 dB, and detailed ones worse by as much, against what the image was made from: it is worth it if it
// brings a part of the image itself nearer by a thirtieth, as ten models showed.
void set_for_measures(const PixelImage& image, WebPConfig& config) {
  config.sns_strength = 0;
  config.segments = 1;
  config.filter_type = 0;
  if (config.lossless != 0) return;
  const PixelImage part = some_bands(image);
  const auto error_with = [&](int filter) {
    config.filter_strength = filter;
    config.method = 2;
    return squared_error(part, decode_webp(run_webp(part, config)));
  };
  config.filter_strength = 30 * error_with(20) < 29 * error_with(0) ? 20 : 0;
  config.method = 6;
}

std::vector<char> encode_webp(const PixelImage& image, int quality) {
  if (std::max(image.size.width, image.size.height) > WEBP_MAX_DIMENSION)
    throw UnsupportedError("has more than " + std::to_string(WEBP_MAX_DIMENSION) + " pixels a side, too many for WebP");
  WebPConfig config;
  if (WebPConfigPreset(&config, WEBP_PRESET_DEFAULT, static_cast<float>(quality)) == 0)
    throw ResourceError("cannot be encoded: another version of libwebp");
  config.lossless = quality == 100 ? 1 : 0;
  config.exact = 1;  // also colours where alpha is zero: filters read them
  config.use_sharp_yuv = 1;
  if (image.channels > 1) return run_webp(image, config);
  const PixelImage wide = three_channels(image);
  set_for_measures(wide, config);
  return run_webp(wide, config);
}

}  // namespace

std::uint64_t squared_error(const PixelImage& a, const PixelImage& b) {
  std::uint64_t sum = 0;
  for (std::size_t p = 0; p < a.pixels.size(); ++p) {
    const int difference = int{a.pixels[p]} - b.pixels[p];
    sum += static_cast<std::uint64_t>(difference * difference);
  }
  return sum;
}

PixelImage decode_image(std::span<const char> bytes, const std::string& media_type) {
  if (media_type == "image/png") return decode_png(bytes);
  if (media_type == "image/jpeg") return decode_jpeg(bytes);
  if (media_type == "image/webp") return decode_webp(bytes);
  refuse_type(media_type);
}

PixelSize image_size(std::span<const char> bytes, const std::string& media_type) {
  if (media_type == "image/png") {
    PngImage png;
    open_png(png, bytes);
    return {png.header.width, png.header.height};
  }
  if (media_type == "image/webp") return read_webp_header(bytes).size;
  if (media_type != "image/jpeg") refuse_type(media_type);
  const TurboHandle turbo(tjInitDecompress(), tjDestroy);
  return read_jpeg_header(turbo.get(), bytes).size;
}

std::vector<char> encode_wide_png(const WideImage& image) {
  PngImage png;
  png.header.width = image.size.width;
  png.header.height = image.size.height;
  png.header.format = PNG_FORMAT_LINEAR_RGB;
  png.header.flags = PNG_IMAGE_FLAG_COLORSPACE_NOT_sRGB;
  std::vector<char> bytes = write_png(png, image.values.data());
  remove_gamma(bytes);
  return bytes;
}

WideImage decode_wide_png(std::span<const char> bytes) {
  PngImage png;
  open_png(png, bytes);
  if (png.header.format != PNG_FORMAT_LINEAR_RGB) throw InputError("is not a PNG image of three channels of 16 bits");
  png.header.flags &= ~png_uint_32{PNG_IMAGE_FLAG_16BIT_sRGB};
  WideImage image{{png.header.width, png.header.height}, {}};
  image.values.resize(3 * std::size_t{image.size.width} * image.size.height);
  read_png(png, image.values.data());
  return image;
}

std::vector<char> encode_image(const PixelImage& image, const std::string& media_type, int quality) {
  if (media_type == "image/png") return encode_png(image);
  if (media_type == "image/jpeg") return encode_jpeg(image, quality);
  if (media_type == "image/webp") return encode_webp(image, quality);
  refuse_type(media_type);
}

}  // namespace lodestone
