#include "render/backends/gl/gl_target.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "core/base/error.h"
#include "render/backends/gl/gl_device.h"
#include "render/shading.h"

namespace lodestone {
namespace {

ImageSize checked(ImageSize size, int max_size) {
  if (size.width < 1 || size.height < 1 || size.width > max_size || size.height > max_size)
    throw InputError("an image of " + std::to_string(size.width) + "x" + std::to_string(size.height) +
                     " pixels is out of range; this OpenGL draws up to " + std::to_string(max_size) + "x" +
                     std::to_string(max_size));
  return size;
}

// OpenGL's rows start at the bottom.
template <class T>
void flip_rows(std::vector<T>& pixels, std::size_t row, std::size_t rows) {
  for (std::size_t y = 0; y < rows / 2; ++y)
    std::swap_ranges(pixels.begin() + static_cast<std::ptrdiff_t>(y * row),
                     pixels.begin() + static_cast<std::ptrdiff_t>((y + 1) * row),
                     pixels.begin() + static_cast<std::ptrdiff_t>((rows - 1 - y) * row));
}

}  // namespace

GlTarget::GlTarget(ImageSize size, int max_size) : size_(checked(size, max_size)) {
  glNamedRenderbufferStorage(colour_.name(), GL_RGBA8, size.width, size.height);
  glNamedRenderbufferStorage(depth_.name(), GL_DEPTH_COMPONENT32F, size.width, size.height);
  check_memory("making the picture");
  glNamedFramebufferRenderbuffer(framebuffer_.name(), GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_.name());
  glNamedFramebufferRenderbuffer(framebuffer_.name(), GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.name());
  assert(glCheckNamedFramebufferStatus(framebuffer_.name(), GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE);
}

void GlTarget::bind() const {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, size_.width, size_.height);
}

void GlTarget::clear() const {
  std::array<float, 4> background{};
  std::transform(shading::background.begin(), shading::background.end(), background.begin(),
                 [](std::uint8_t v) { return static_cast<float>(v) / 255; });
  const float farthest = 1;
  glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, background.data());
  glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &farthest);
}

Image GlTarget::read() const {
  Image image;
  image.size = size_;
  const auto width = static_cast<std::size_t>(size_.width), height = static_cast<std::size_t>(size_.height);
  image.rgba.resize(width * height * 4);
  image.depth.resize(width * height);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.name());
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  for (const GLenum skipped : {GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS, GL_PACK_SWAP_BYTES})
    glPixelStorei(skipped, 0);
  glReadPixels(0, 0, size_.width, size_.height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  glReadPixels(0, 0, size_.width, size_.height, GL_DEPTH_COMPONENT, GL_FLOAT, image.depth.data());
  flip_rows(image.rgba, width * 4, height);
  flip_rows(image.depth, width, height);
  return image;
}

}  // namespace lodestone
