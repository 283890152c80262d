#include "render/backends/gl/device/target.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "render/backends/gl/device/device.h"

namespace lodestone {
namespace {

// OpenGL's rows start at the bottom.
template <class T>
void flip_rows(std::vector<T>& pixels, std::size_t row, std::size_t rows) {
  for (std::size_t y = 0; y < rows / 2; ++y)
    std::swap_ranges(pixels.begin() + static_cast<std::ptrdiff_t>(y * row),
                     pixels.begin() + static_cast<std::ptrdiff_t>((y + 1) * row),
                     pixels.begin() + static_cast<std::ptrdiff_t>((rows - 1 - y) * row));
}

}  // namespace

GlTexture make_plane(GLenum format, ImageSize size, int samples) {
  GLuint name = 0;
  glCreateTextures(samples == 1 ? GL_TEXTURE_2D : GL_TEXTURE_2D_MULTISAMPLE, 1, &name);
  if (samples == 1)
    glTextureStorage2D(name, 1, format, size.width, size.height);
  else
    glTextureStorage2DMultisample(name, samples, format, size.width, size.height, GL_TRUE);
  return GlTexture(name);
}

GlTarget::Planes::Planes(ImageSize size, int samples)
    : colour(make_plane(GL_RGBA8, size, samples)), depth(make_plane(GL_DEPTH_COMPONENT32F, size, samples)) {
  check_memory("making the picture");
  glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, colour.name(), 0);
  glNamedFramebufferTexture(framebuffer.name(), GL_DEPTH_ATTACHMENT, depth.name(), 0);
  assert(glCheckNamedFramebufferStatus(framebuffer.name(), GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE);
}

GlTarget::GlTarget(ImageSize size, int samples) : size_(size), samples_(samples), drawn_(size, samples) {
  if (samples > 1) averaged_.emplace(size, 1);
}

void GlTarget::bind() const {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, drawn_.framebuffer.name());
  glViewport(0, 0, size_.width, size_.height);
}

void GlTarget::bind_result() const {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, result().framebuffer.name());
  glViewport(0, 0, size_.width, size_.height);
}

void GlTarget::clear(Vec3f background) const {
  const std::array<float, 4> colour{background.x, background.y, background.z, 1};
  const float farthest = 1;
  glClearNamedFramebufferfv(drawn_.framebuffer.name(), GL_COLOR, 0, colour.data());
  glClearNamedFramebufferfv(drawn_.framebuffer.name(), GL_DEPTH, 0, &farthest);
}

void GlTarget::average() const {
  if (!averaged_) return;
  const auto [width, height] = size_;
  glBlitNamedFramebuffer(drawn_.framebuffer.name(), averaged_->framebuffer.name(), 0, 0, width, height, 0, 0, width,
                         height, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, GL_NEAREST);
}

void GlTarget::copy_to(GLuint framebuffer) const {
  const auto [width, height] = size_;
  const Planes& shown = averaged_ ? *averaged_ : drawn_;
  glDisable(GL_SCISSOR_TEST);
  glBlitNamedFramebuffer(shown.framebuffer.name(), framebuffer, 0, 0, width, height, 0, height, width, 0,
                         GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

Image GlTarget::read() const {
  Image image;
  image.size = size_;
  const auto width = static_cast<std::size_t>(size_.width), height = static_cast<std::size_t>(size_.height);
  image.rgba.resize(width * height * 4);
  image.depth.resize(width * height);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, result().framebuffer.name());
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
