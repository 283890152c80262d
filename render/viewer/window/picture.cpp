#include "render/viewer/window/picture.h"

#include <epoxy/gl.h>

#include <algorithm>

#include "render/backends/gl/gl_renderer.h"

namespace lodestone::viewer {
namespace {

// Other users of the context may have changed it.
void set_packing() {
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  for (const GLenum four : {GL_UNPACK_ALIGNMENT, GL_PACK_ALIGNMENT}) glPixelStorei(four, 4);
  for (const GLenum none : {GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS, GL_PACK_ROW_LENGTH,
                            GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS})
    glPixelStorei(none, 0);
}

}  // namespace

Picture::Picture() {
  glGenTextures(1, &texture_);
  glGenFramebuffers(1, &framebuffer_);
}

Picture::~Picture() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteTextures(1, &texture_);
}

void Picture::resize(ImageSize size) {
  glBindTexture(GL_TEXTURE_2D, texture_);
  if (size == size_) return;
  set_packing();
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, size.width, size.height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
  glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  size_ = size;
}

void Picture::set(const Image& image) {
  resize(image.size);
  set_packing();
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, size_.width, size_.height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
}

void Picture::copy_from(GlRenderer& renderer, ImageSize size) {
  resize(size);
  renderer.copy_to(framebuffer_);
}

void Picture::fit(ImageSize shown) const {
  const GLint filter = shown == size_ ? GL_NEAREST : GL_LINEAR;
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
}

Image read_window(ImageSize window, Rect part) {
  Image image;
  image.size = part.size();
  const auto width = static_cast<std::size_t>(part.width), height = static_cast<std::size_t>(part.height);
  image.rgba.resize(4 * width * height);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  glReadBuffer(GL_BACK);
  set_packing();
  glReadPixels(part.x, window.height - part.y - part.height, part.width, part.height, GL_RGBA, GL_UNSIGNED_BYTE,
               image.rgba.data());
  const auto row = [&](std::size_t y) { return image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * width * y); };
  for (std::size_t y = 0; y < height / 2; ++y) std::swap_ranges(row(y), row(y + 1), row(height - 1 - y));
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;  // a window has no alpha to speak of
  return image;
}

void clear_window(ImageSize size) {
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, size.width, size.height);
  glDisable(GL_SCISSOR_TEST);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const Vec3f background = FrameSettings{}.background;
  glClearColor(background.x, background.y, background.z, 1);
  glClear(GL_COLOR_BUFFER_BIT);
}

}  // namespace lodestone::viewer
