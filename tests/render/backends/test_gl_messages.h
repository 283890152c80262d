// Errors that OpenGL reports to the current context, counted and printed.
#pragma once

#include <epoxy/gl.h>

#include <cstdio>

namespace lodestone::test {

class GlMessages {
 public:
  // For the context that is current, as long as this lives.
  GlMessages() {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_message, this);
  }
  ~GlMessages() { glDebugMessageCallback(nullptr, nullptr); }
  GlMessages(const GlMessages&) = delete;
  GlMessages& operator=(const GlMessages&) = delete;

  [[nodiscard]] int errors() const { return errors_; }

 private:
  static void APIENTRY on_message(GLenum, GLenum type, GLuint, GLenum, GLsizei, const GLchar* message,
                                  const void* self) {
    if (type != GL_DEBUG_TYPE_ERROR) return;
    ++static_cast<GlMessages*>(const_cast<void*>(self))->errors_;
    std::fprintf(stderr, "OpenGL: %s\n", message);
  }

  int errors_ = 0;
};

}  // namespace lodestone::test
