#include "render/backends/gl/passes/capture_pass.h"

#include <cassert>

#include "render/backends/gl/device/device.h"

namespace lodestone {

std::vector<Vec3f> capture_triangles(const GlCommands& commands, const GlScene& scene,
                                     const std::function<void(const GlPipeline&)>& use) {
  std::vector<Vec3f> corners(static_cast<std::size_t>(3 * commands.triangles()));
  if (corners.empty()) return corners;

  const auto bytes = static_cast<GLsizeiptr>(corners.size() * sizeof(Vec3f));
  const GlBuffer captured;
  const GlPrimitiveCounter written;
  glNamedBufferStorage(captured.name(), bytes, nullptr, 0);
  check_memory("capturing the drawn triangles");
  const GlFramebuffer nowhere;  // without a window there is none that could remain bound
  glNamedFramebufferParameteri(nowhere.name(), GL_FRAMEBUFFER_DEFAULT_WIDTH, 1);
  glNamedFramebufferParameteri(nowhere.name(), GL_FRAMEBUFFER_DEFAULT_HEIGHT, 1);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, nowhere.name());
  glEnable(GL_RASTERIZER_DISCARD);
  glBeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, written.name());
  // A program may not change while its vertices are captured: each pipeline has its part of the buffer.
  std::uint64_t before = 0;
  commands.draw(scene, [&](const GlPipeline& pipeline) {
    if (before > 0) glEndTransformFeedback();
    use(pipeline);
    constexpr std::uint64_t triangle_bytes = 3 * sizeof(Vec3f);
    glBindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, captured.name(), static_cast<GLintptr>(before * triangle_bytes),
                      static_cast<GLsizeiptr>(pipeline.triangles * triangle_bytes));
    glBeginTransformFeedback(GL_TRIANGLES);
    before += pipeline.triangles;
  });
  glEndTransformFeedback();
  glEndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
  glDisable(GL_RASTERIZER_DISCARD);
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
  GLuint64 triangles = 0;
  glGetQueryObjectui64v(written.name(), GL_QUERY_RESULT, &triangles);
  assert(triangles == commands.triangles());
  glGetNamedBufferSubData(captured.name(), 0, bytes, corners.data());
  return corners;
}

}  // namespace lodestone
