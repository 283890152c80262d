// PNG, JPEG and WebP: any bytes give pixels that can be halved and encoded again, or an Error. Checksums would keep the
// fuzzer out of a PNG, so that the harness sets them right.
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "core/base/error.h"
#include "core/files/checksum.h"
#include "core/texture/downsample.h"

namespace {

using namespace lodestone;

// A PNG is chunks after a signature of 8 bytes; each is the size of its data (4 bytes, the highest first), a name of 4
// bytes, the data, and the checksum of the name and the data.
void mend_checksums(std::span<char> bytes) {
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    std::size_t length = 0;
    for (int k = 0; k < 4; ++k)
      length = length << 8 | static_cast<std::uint8_t>(bytes[at + static_cast<std::size_t>(k)]);
    if (length > bytes.size() - at - 12) return;
    const std::uint32_t crc = crc32(std::as_bytes(bytes.subspan(at + 4, 4 + length)));
    at += 8 + length;
    for (int k = 0; k < 4; ++k) bytes[at++] = static_cast<char>(crc >> (24 - 8 * k));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<char> bytes(data, data + size);
  if (size >= 8 && data[0] == 0x89) mend_checksums(bytes);
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
