// Data of a frame on its way to the device: one buffer that remains mapped (persistent, coherent), used in turn by the
// frames that may be under way at once, and its copy in the device's own memory, which shaders read.
//
// A region of it is written again only when the device is done with the frame that used it last (a fence says so), and
// no call allocates or orphans anything once the buffers are large enough.
//
// Rejected: shaders that read what is mapped. Every vertex then fetches its lambda from the other side of the bus: on
// an H100 ten times of what drawing takes.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "render/backends/gl/device/object.h"

namespace lodestone {

// Part of a buffer.
struct GlRange {
  GLuint buffer = 0;
  GLintptr offset = 0;
  GLsizeiptr bytes = 0;

  void bind(GLenum target, GLuint index) const { glBindBufferRange(target, index, buffer, offset, bytes); }
};

class GlStream {
 public:
  GlStream() = default;
  GlStream(const GlStream&) = delete;
  GlStream& operator=(const GlStream&) = delete;
  ~GlStream();

  // Ranges given since the last call belong to a frame that ends here. Waits for the device where it is three frames
  // behind.
  void next_frame();

  // Copies the values; an empty range becomes four bytes, as OpenGL has no empty ranges. The range is aligned for every
  // use and is kept until three frames later.
  template <class T>
  GlRange write(std::span<const T> values) {
    return write_bytes(std::as_bytes(values));
  }

  [[nodiscard]] std::size_t bytes() const { return region_bytes_ * regions; }  // of each buffer

 private:
  static constexpr std::size_t regions = 3;
  GlRange write_bytes(std::span<const std::byte> bytes);
  void grow(std::size_t needed);
  void forget_fence(std::size_t region);

  GlBuffer buffer_, copy_;
  std::vector<GlBuffer> outgrown_;  // smaller ones that this frame still reads
  std::byte* mapped_ = nullptr;
  std::size_t region_bytes_ = 0, region_ = 0, used_ = 0, alignment_ = 0;
  std::array<GLsync, regions> fences_{};
};

}  // namespace lodestone
