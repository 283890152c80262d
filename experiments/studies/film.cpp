#include "experiments/studies/film.h"

#include <webp/encode.h>
#include <webp/mux.h>

#include <cstddef>
#include <memory>

#include "core/base/error.h"
#include "core/files/atomic_file.h"

namespace lodestone {
namespace {

void expect(bool good, const char* what) {
  if (!good) throw ResourceError(std::string("a film cannot be encoded: libwebp fails to ") + what);
}

struct Free {
  void operator()(WebPAnimEncoder* encoder) const { WebPAnimEncoderDelete(encoder); }
  void operator()(WebPPicture* picture) const { WebPPictureFree(picture); }
  void operator()(WebPData* data) const { WebPDataClear(data); }
};

std::unique_ptr<WebPAnimEncoder, Free> encoder_of(ImageSize size) {
  WebPAnimEncoderOptions options;
  expect(WebPAnimEncoderOptionsInit(&options) != 0, "begin");
  std::unique_ptr<WebPAnimEncoder, Free> encoder(WebPAnimEncoderNew(size.width, size.height, &options));
  expect(encoder != nullptr, "begin");
  return encoder;
}

void add(WebPAnimEncoder* encoder, const Image& image, int time) {
  WebPPicture frame;
  expect(WebPPictureInit(&frame) != 0, "begin a picture");
  const std::unique_ptr<WebPPicture, Free> freed(&frame);
  frame.use_argb = 1;
  frame.width = image.size.width, frame.height = image.size.height;
  expect(WebPPictureImportRGBX(&frame, image.rgba.data(), 4 * image.size.width) != 0, "take a picture");
  WebPConfig config;
  expect(WebPConfigInit(&config) != 0, "begin a picture");
  expect(WebPAnimEncoderAdd(encoder, &frame, time, &config) != 0, "add a picture");
}

}  // namespace

void write_film(const std::string& file, std::span<const Image> pictures, int milliseconds) {
  if (pictures.empty()) throw InputError("a film needs at least one picture");
  const ImageSize size = pictures.front().size;
  for (const Image& picture : pictures)
    if (picture.size != size || picture.rgba.size() != std::size_t{4} * size.width * size.height)
      throw InputError("the pictures of a film must have one size");
  const auto encoder = encoder_of(size);
  int time = 0;
  for (const Image& picture : pictures) {
    add(encoder.get(), picture, time);
    time += milliseconds;
  }
  expect(WebPAnimEncoderAdd(encoder.get(), nullptr, time, nullptr) != 0,
         "end");  // tells how long the last one is shown
  WebPData data;
  WebPDataInit(&data);
  const std::unique_ptr<WebPData, Free> freed(&data);
  expect(WebPAnimEncoderAssemble(encoder.get(), &data) != 0, "end");
  AtomicFile out(file);
  out.write(std::as_bytes(std::span(data.bytes, data.size)));
  out.commit();
}

}  // namespace lodestone
