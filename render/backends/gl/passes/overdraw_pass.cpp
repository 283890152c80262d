#include "render/backends/gl/passes/overdraw_pass.h"

#include <array>

#include "render/backends/gl/device/device.h"
#include "render/backends/gl/device/program.h"
#include "render/frame/shading.h"

namespace lodestone {
namespace {

constexpr const char* colours_source = R"(
layout(binding = 9) uniform sampler2D counts;
layout(binding = 10) uniform sampler2D depth;
layout(location = 0) out vec4 colour;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  int count = int(texelFetch(counts, at, 0).r);
  if (count == 0) discard;
  colour = vec4(ramp[min(count, MOST) - 1], 1.0);
  gl_FragDepth = texelFetch(depth, at, 0).r;
}
)";

std::string ramp_source() {
  std::string colours;
  for (std::uint32_t n = 1; n <= shading::overdraw_most; ++n) {
    const Vec3f c = shading::overdraw_colour(n);
    colours += (n > 1 ? ", vec3(" : "vec3(") + std::to_string(c.x) + ", " + std::to_string(c.y) + ", " +
               std::to_string(c.z) + ")";
  }
  const std::string most = std::to_string(shading::overdraw_most);
  return "#define MOST " + most + "\nconst vec3 ramp[" + most + "] = vec3[" + most + "](" + colours + ");\n";
}

}  // namespace

GlOverdraw::GlOverdraw(ImageSize size) : size_(size), colours_(make_screen_program(ramp_source() + colours_source)) {
  glTextureStorage2D(counts_.name(), 1, GL_R32F, size.width, size.height);
  glTextureStorage2D(depth_.name(), 1, GL_DEPTH_COMPONENT32F, size.width, size.height);
  check_memory("making the overdraw count");
  glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, counts_.name(), 0);
  glNamedFramebufferTexture(framebuffer_.name(), GL_DEPTH_ATTACHMENT, depth_.name(), 0);
}

// Depth first, with a depth test; then all triangles add up without one.
std::uint64_t GlOverdraw::draw(const GlCommands& commands, const GlScene& scene,
                               const std::function<void(const GlPipeline&)>& use, const GlTarget& target) {
  const std::array<float, 4> none{};
  const float farthest = 1;
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, size_.width, size_.height);
  glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, none.data());
  glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &farthest);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  commands.draw(scene, use);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glBeginQuery(GL_SAMPLES_PASSED, covered_.name());
  commands.draw(scene, use);
  glEndQuery(GL_SAMPLES_PASSED);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);

  target.bind();  // cleared
  glDepthFunc(GL_ALWAYS);
  glBindTextureUnit(9, counts_.name());
  glBindTextureUnit(10, depth_.name());
  glUseProgram(colours_.name());
  draw_screen(nothing_);
  glDepthFunc(GL_LESS);
  GLuint64 covered = 0;
  glGetQueryObjectui64v(covered_.name(), GL_QUERY_RESULT, &covered);
  return covered;
}

}  // namespace lodestone
