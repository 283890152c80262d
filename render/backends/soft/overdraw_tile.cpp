#include "render/backends/soft/overdraw_tile.h"

#include <array>

#include "render/frame/shading.h"

namespace lodestone::soft {
namespace {

using Pixel = std::array<std::uint8_t, 4>;

constexpr Pixel bytes_of(Vec3f c) { return {shading::to_byte(c.x), shading::to_byte(c.y), shading::to_byte(c.z), 255}; }

constexpr auto colours = [] {
  std::array<Pixel, shading::overdraw_most + 1> bytes{};
  for (std::uint32_t n = 1; n < bytes.size(); ++n) {
    bytes[n] = bytes_of(shading::overdraw_colour(n));
  }
  return bytes;
}();

}  // namespace

std::uint64_t draw_overdraw(const Kernels& kernels, std::span<const GeometryStage::Workplace> workers, std::size_t tile,
                            PixelRect rect, Vec3f background, Image& image) {
  alignas(64) std::array<std::int32_t, tile_pixels> counts{};
  count_tile<1>(kernels, workers, tile, rect, counts.data());
  const Pixel none = bytes_of(background);
  std::uint64_t sum = 0;
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) {
      const auto count =
          static_cast<std::uint32_t>(counts[static_cast<std::size_t>((y - rect.y0) * tile_size + x - rect.x0)]);
      sum += count;
      const Pixel& colour = count == 0 ? none : colours[std::min(count, shading::overdraw_most)];
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(image.size.width) + static_cast<std::size_t>(x);
      std::copy(colour.begin(), colour.end(), &image.rgba[4 * pixel]);
    }
  return sum;
}

}  // namespace lodestone::soft
