// PNG, JPEG and WebP: any bytes give pixels that can be halved and encoded again, or an Error.
#include <cstdint>
#include <cstdlib>

#include "core/base/error.h"
#include "core/texture/downsample.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  const std::span<const char> bytes(reinterpret_cast<const char*>(data), size);
  try {
    if (const PixelSize png = image_size(bytes, "image/png"); std::uint64_t{png.width} * png.height <= 1u << 20) {
      const WideImage wide = decode_wide_png(bytes);
      if (decode_wide_png(encode_wide_png(wide)) != wide) std::abort();
    }
  } catch (const Error&) {
  }
  for (const char* type : {"image/png", "image/jpeg", "image/webp"}) {
    try {
      const PixelSize declared = image_size(bytes, type);
      if (std::uint64_t{declared.width} * declared.height > 1u << 20) return 0;  // it is not memory that is tested
      PixelImage image = decode_image(bytes, type);
      if (image.size != declared) std::abort();
      PixelImage half = to_pixels(halve(to_linear(image, PixelMeaning::colours)), PixelMeaning::colours);
      half.chroma = image.chroma;
      if (half.size != half_of(declared) || encode_image(half, type).empty()) std::abort();
    } catch (const Error&) {
    }
  }
  return 0;
}
