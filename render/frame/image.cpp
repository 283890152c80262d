#include "render/frame/image.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "core/base/error.h"
#include "core/files/atomic_file.h"

namespace lodestone {
namespace {

constexpr std::size_t channels = 4;
// Larger pictures are taken for a broken header.
constexpr png_uint_32 longest_side = 32768;

std::size_t pixels(ImageSize size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

void check(const Image& image) {
  if (image.size.width < 1 || image.size.height < 1 || image.rgba.size() != channels * pixels(image.size))
    throw InputError("an image without pixels, or with another number of them than its size says");
}

// libpng's simplified interface; freed on every path out.
struct Png {
  png_image header{};
  Png() { header.version = PNG_IMAGE_VERSION; }
  ~Png() { png_image_free(&header); }
  Png(const Png&) = delete;
  Png& operator=(const Png&) = delete;
};

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

// The pixels of the source that a pixel of the target covers, in one direction: [begin, end), with partial ends.
struct Coverage {
  int begin = 0, end = 0;
  double first_weight = 1, last_weight = 1;
};

std::vector<Coverage> coverage(int from, int to) {
  std::vector<Coverage> all(static_cast<std::size_t>(to));
  for (int i = 0; i < to; ++i) {
    const double lo = static_cast<double>(i) * from / to, hi = static_cast<double>(i + 1) * from / to;
    Coverage& c = all[static_cast<std::size_t>(i)];
    c.begin = static_cast<int>(lo);
    c.end = std::min(static_cast<int>(std::ceil(hi)), from);
    c.first_weight = std::min<double>(c.begin + 1, hi) - lo;
    c.last_weight = hi - (c.end - 1);
  }
  return all;
}

double weight(const Coverage& c, int i) {
  if (i == c.begin) return c.first_weight;
  return i == c.end - 1 ? c.last_weight : 1;
}

void copy_into(const Image& from, Image& to, int left, int top) {
  const std::size_t row_bytes = channels * static_cast<std::size_t>(from.size.width);
  for (int y = 0; y < from.size.height; ++y) {
    const auto target = channels * (static_cast<std::size_t>(top + y) * static_cast<std::size_t>(to.size.width) +
                                    static_cast<std::size_t>(left));
    std::copy_n(from.rgba.begin() + static_cast<std::ptrdiff_t>(row_bytes * static_cast<std::size_t>(y)), row_bytes,
                to.rgba.begin() + static_cast<std::ptrdiff_t>(target));
  }
}

// Between the frames of a contact sheet, lighter than the background of the frames.
constexpr std::array<std::uint8_t, channels> sheet_colour{58, 62, 70, 255};

Image empty_sheet(ImageSize size) {
  Image image{size, std::vector<std::uint8_t>(channels * pixels(size)), {}};
  for (std::size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = sheet_colour[i % channels];
  return image;
}

}  // namespace

std::vector<std::byte> encode_png(const Image& image) {
  check(image);
  Png png;
  png.header.width = static_cast<png_uint_32>(image.size.width);
  png.header.height = static_cast<png_uint_32>(image.size.height);
  png.header.format = PNG_FORMAT_RGBA;
  std::vector<std::byte> bytes(PNG_IMAGE_PNG_SIZE_MAX(png.header));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&png.header, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr) == 0)
    throw ResourceError(describe({}, {}, "the picture cannot be encoded", png.header.message));
  bytes.resize(size);
  return bytes;
}

void write_png(const std::string& file, const Image& image) {
  const std::vector<std::byte> bytes = encode_png(image);
  AtomicFile out(file);
  out.write(bytes);
  out.commit();
}

Image read_png(const std::string& file) {
  const File in(std::fopen(file.c_str(), "rb"));
  if (!in) throw FileError(describe(file, {}, "cannot be opened for reading"));
  Png png;
  if (png_image_begin_read_from_stdio(&png.header, in.get()) == 0)
    throw InputError(describe(file, {}, "is not a PNG image", png.header.message));
  if (png.header.width > longest_side || png.header.height > longest_side)
    throw InputError(describe(file, "header", "the image is larger than 32768 pixels in a direction"));
  png.header.format = PNG_FORMAT_RGBA;
  Image image;
  image.size = {static_cast<int>(png.header.width), static_cast<int>(png.header.height)};
  image.rgba.resize(PNG_IMAGE_SIZE(png.header));
  if (png_image_finish_read(&png.header, nullptr, image.rgba.data(), 0, nullptr) == 0)
    throw InputError(describe(file, {}, "is a damaged PNG image", png.header.message));
  return image;
}

Image downscale(const Image& image, ImageSize size) {
  check(image);
  if (size.width < 1 || size.height < 1 || size.width > image.size.width || size.height > image.size.height)
    throw InputError("an image can only be scaled down, to at least one pixel");
  const std::vector<Coverage> columns = coverage(image.size.width, size.width);
  const std::vector<Coverage> rows = coverage(image.size.height, size.height);
  const double area = static_cast<double>(pixels(image.size)) / static_cast<double>(pixels(size));
  Image small{size, std::vector<std::uint8_t>(channels * pixels(size)), {}};
  std::uint8_t* out = small.rgba.data();
  for (const Coverage& row : rows) {
    for (const Coverage& column : columns) {
      double sum[channels] = {};
      for (int y = row.begin; y < row.end; ++y) {
        for (int x = column.begin; x < column.end; ++x) {
          const double w = weight(row, y) * weight(column, x);
          const std::uint8_t* in = &image.rgba[channels * (static_cast<std::size_t>(y) * image.size.width + x)];
          for (std::size_t c = 0; c < channels; ++c) sum[c] += w * in[c];
        }
      }
      for (const double s : sum) *out++ = static_cast<std::uint8_t>(std::clamp(s / area + 0.5, 0.0, 255.0));
    }
  }
  return small;
}

Image contact_sheet(std::span<const Image> frames, const ContactSheetConfig& config) {
  if (frames.empty()) throw InputError("a contact sheet needs at least one frame");
  for (const Image& frame : frames) {
    check(frame);
    if (frame.size != frames.front().size) throw InputError("the frames of a contact sheet must have one size");
  }
  const ImageSize full = frames.front().size;
  const auto count = static_cast<int>(frames.size());
  // Columns of a sheet just wider than square: columns * width is at least rows * height.
  const double square = std::sqrt(static_cast<double>(count) * full.height / full.width);
  const int wanted = config.columns > 0 ? config.columns : static_cast<int>(std::ceil(square));
  const int columns = std::clamp(wanted, 1, count), rows = (count + columns - 1) / columns;
  const int gap = std::max(config.gap, 0);
  const int width = std::min((config.width - gap * (columns + 1)) / columns, full.width);
  if (width < 1)
    throw InputError("the contact sheet is too narrow for its columns; make it wider or use fewer columns");
  const auto scaled = static_cast<int>(std::lround(static_cast<double>(full.height) * width / full.width));
  const int height = std::clamp(scaled, 1, full.height);

  Image sheet = empty_sheet({columns * (width + gap) + gap, rows * (height + gap) + gap});
  for (int i = 0; i < count; ++i)
    copy_into(downscale(frames[static_cast<std::size_t>(i)], {width, height}), sheet,
              gap + (i % columns) * (width + gap), gap + (i / columns) * (height + gap));
  return sheet;
}

ImageDifference image_difference(const Image& a, const Image& b, int threshold) {
  check(a);
  check(b);
  if (a.size != b.size) throw InputError("images of different sizes cannot be compared");
  ImageDifference result;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += channels) {
    int worst = 0;
    for (std::size_t c = i; c < i + channels; ++c) {
      const int d = std::abs(int{a.rgba[c]} - int{b.rgba[c]});
      sum += static_cast<std::uint64_t>(d);
      worst = std::max(worst, d);
    }
    result.max = std::max(result.max, worst);
    if (worst > threshold) ++result.differing;
  }
  result.mean_absolute = static_cast<double>(sum) / static_cast<double>(a.rgba.size());
  result.differing_share = static_cast<double>(result.differing) / static_cast<double>(pixels(a.size));
  return result;
}

}  // namespace lodestone
