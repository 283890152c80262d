#include "render/backends/gl/device/stream.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/base/error.h"
#include "render/backends/gl/device/device.h"

namespace lodestone {
namespace {

constexpr std::size_t least_region = 256 << 10;  // bytes
constexpr GLbitfield access = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;

// Offsets are multiples of this, whatever the range is bound as.
std::size_t alignment_for_all() {
  std::size_t alignment = 16;
  for (const GLenum name : {GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT}) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    alignment = std::max(alignment, std::bit_ceil(static_cast<std::size_t>(std::max(value, 1))));
  }
  return alignment;
}

}  // namespace

GlStream::~GlStream() {
  for (std::size_t region = 0; region < regions; ++region) forget_fence(region);
}

void GlStream::forget_fence(std::size_t region) {
  if (fences_[region]) glDeleteSync(fences_[region]);
  fences_[region] = nullptr;
}

void GlStream::next_frame() {
  outgrown_.clear();
  if (used_ > 0) {
    forget_fence(region_);
    fences_[region_] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    region_ = (region_ + 1) % regions;
    used_ = 0;
  }
  if (!fences_[region_]) return;
  constexpr GLuint64 a_while = 1'000'000'000;  // nanoseconds
  while (glClientWaitSync(fences_[region_], GL_SYNC_FLUSH_COMMANDS_BIT, a_while) == GL_TIMEOUT_EXPIRED) {
  }
  forget_fence(region_);
}

// A new buffer has nothing under way. The old one lives until its frame ends; the driver keeps it as long as it must.
void GlStream::grow(std::size_t needed) {
  if (alignment_ == 0) alignment_ = alignment_for_all();
  region_bytes_ = std::bit_ceil(std::max(needed, least_region));
  GlBuffer larger, larger_copy;
  const auto bytes = static_cast<GLsizeiptr>(regions * region_bytes_);
  glNamedBufferStorage(larger.name(), bytes, nullptr, access);
  glNamedBufferStorage(larger_copy.name(), bytes, nullptr, 0);
  check_memory("sending a frame");
  mapped_ = static_cast<std::byte*>(glMapNamedBufferRange(larger.name(), 0, bytes, access));
  if (!mapped_) throw ResourceError(describe("", "OpenGL", "a buffer cannot be mapped", "use --backend soft"));
  std::swap(buffer_, larger);
  std::swap(copy_, larger_copy);
  outgrown_.push_back(std::move(larger));
  outgrown_.push_back(std::move(larger_copy));
  for (std::size_t region = 0; region < regions; ++region) forget_fence(region);
  region_ = used_ = 0;
}

GlRange GlStream::write_bytes(std::span<const std::byte> bytes) {
  const std::size_t size = std::max<std::size_t>(bytes.size(), 4);
  if (region_bytes_ == 0 || used_ + size > region_bytes_) grow(2 * (used_ + size));
  const std::size_t at = region_ * region_bytes_ + used_;
  if (!bytes.empty()) {
    std::memcpy(mapped_ + at, bytes.data(), bytes.size());
    glCopyNamedBufferSubData(buffer_.name(), copy_.name(), static_cast<GLintptr>(at), static_cast<GLintptr>(at),
                             static_cast<GLsizeiptr>(bytes.size()));
  }
  used_ = (used_ + size + alignment_ - 1) / alignment_ * alignment_;
  return {copy_.name(), static_cast<GLintptr>(at), static_cast<GLsizeiptr>(size)};
}

}  // namespace lodestone
