#include "render/backends/gl/device/device.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cassert>
#include <cstdio>

#include "core/base/error.h"
#include "render/backends/gl/device/graphics_driver.h"

namespace lodestone {
namespace {

constexpr int needed_version = 45;       // as epoxy counts: 10 major + minor
constexpr int needed_vertex_blocks = 3;  // positions and normals of the parents

int integer(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

std::string text(GLenum name) {
  const auto* value = reinterpret_cast<const char*>(glGetString(name));
  return value ? value : "unknown";
}

#ifndef NDEBUG
void APIENTRY on_message(GLenum, GLenum type, GLuint, GLenum severity, GLsizei, const GLchar* message, const void*) {
  const bool chatter =
      severity == GL_DEBUG_SEVERITY_NOTIFICATION || type == GL_DEBUG_TYPE_PERFORMANCE || type == GL_DEBUG_TYPE_OTHER;
  if (chatter) return;
  std::fprintf(stderr, "OpenGL: %s\n", message);
  assert(type != GL_DEBUG_TYPE_ERROR && "an OpenGL call was wrong");
}
#endif

}  // namespace

GlDevice query_device() {
  GlDevice device;
  device.renderer = text(GL_RENDERER);
  device.version = text(GL_VERSION);
  note_graphics_driver({text(GL_VENDOR), device.renderer, device.version});
  if (const int version = epoxy_gl_version(); version < needed_version)
    throw UnsupportedError("OpenGL 4.5 is missing: " + device.renderer + " has " + std::to_string(version / 10) + "." +
                           std::to_string(version % 10));
  if (const int blocks = integer(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS); blocks < needed_vertex_blocks)
    throw UnsupportedError("storage blocks in vertex shaders are missing: " + device.renderer + " has " +
                           std::to_string(blocks) + " of " + std::to_string(needed_vertex_blocks));
  GLint64 bytes = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
  device.max_storage_block_bytes = static_cast<std::size_t>(bytes);
  GLint viewport[2] = {0, 0};
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  device.max_target_size = std::min({viewport[0], viewport[1], integer(GL_MAX_RENDERBUFFER_SIZE)});
  return device;
}

void watch_errors() {
#ifndef NDEBUG
  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(on_message, nullptr);
#endif
}

void check_memory(const std::string& what) {
  while (const GLenum error = glGetError()) {
    if (error == GL_OUT_OF_MEMORY)
      throw ResourceError(
          describe("", "OpenGL", "out of memory while " + what, "use a smaller model or --backend soft"));
    assert(error == GL_NO_ERROR);
  }
}

}  // namespace lodestone
