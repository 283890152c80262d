// Owners of OpenGL names. Their context must be current when they are made and when they end.
#pragma once

#include <epoxy/gl.h>

#include <utility>

namespace lodestone {

// Move-only owner of one name; Kind::make and Kind::free say how.
template <class Kind>
class GlObject {
 public:
  GlObject() : name_(Kind::make()) {}
  explicit GlObject(GLuint name) : name_(name) {}
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlObject() {
    if (name_) Kind::free(name_);
  }
  [[nodiscard]] GLuint name() const { return name_; }

 private:
  GLuint name_;
};

// Most kinds are made and freed by the same pair of signatures.
#define LODESTONE_GL_KIND(Kind, create, destroy) \
  struct Kind {                                  \
    static GLuint make() {                       \
      GLuint name = 0;                           \
      create;                                    \
      return name;                               \
    }                                            \
    static void free(GLuint name) { destroy; }   \
  }

LODESTONE_GL_KIND(BufferKind, glCreateBuffers(1, &name), glDeleteBuffers(1, &name));
LODESTONE_GL_KIND(VertexArrayKind, glCreateVertexArrays(1, &name), glDeleteVertexArrays(1, &name));
LODESTONE_GL_KIND(FramebufferKind, glCreateFramebuffers(1, &name), glDeleteFramebuffers(1, &name));
LODESTONE_GL_KIND(TextureArrayKind, glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name), glDeleteTextures(1, &name));
LODESTONE_GL_KIND(RenderbufferKind, glCreateRenderbuffers(1, &name), glDeleteRenderbuffers(1, &name));
LODESTONE_GL_KIND(TextureKind, glCreateTextures(GL_TEXTURE_2D, 1, &name), glDeleteTextures(1, &name));
LODESTONE_GL_KIND(TimerKind, glCreateQueries(GL_TIME_ELAPSED, 1, &name), glDeleteQueries(1, &name));
LODESTONE_GL_KIND(PrimitiveCounterKind, glCreateQueries(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, 1, &name),
                  glDeleteQueries(1, &name));
LODESTONE_GL_KIND(SampleCounterKind, glCreateQueries(GL_SAMPLES_PASSED, 1, &name), glDeleteQueries(1, &name));
LODESTONE_GL_KIND(ProgramKind, name = glCreateProgram(), glDeleteProgram(name));
#undef LODESTONE_GL_KIND

using GlBuffer = GlObject<BufferKind>;
using GlVertexArray = GlObject<VertexArrayKind>;
using GlFramebuffer = GlObject<FramebufferKind>;
using GlRenderbuffer = GlObject<RenderbufferKind>;
using GlTextureArray = GlObject<TextureArrayKind>;
using GlTexture = GlObject<TextureKind>;
using GlTimer = GlObject<TimerKind>;
using GlPrimitiveCounter = GlObject<PrimitiveCounterKind>;
using GlSampleCounter = GlObject<SampleCounterKind>;
using GlProgram = GlObject<ProgramKind>;

}  // namespace lodestone
