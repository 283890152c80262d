#include "render/backends/gl/passes/cut_pass.h"

#include <array>

#include "render/backends/gl/device/device.h"
#include "render/backends/gl/device/program.h"

namespace lodestone {
namespace {

constexpr const char* fill_source = R"(
layout(location = 0) uniform vec3 depth_of_plane;  // gl_FragCoord.xy, 1
layout(location = 1) uniform vec3 cut_colour;
layout(location = 2) uniform vec4 fog;   // colour, density
layout(location = 3) uniform vec4 lens;  // tan_x, tan_y, near, far
layout(location = 4) uniform vec2 size;
#ifdef MULTISAMPLED
layout(binding = 9) uniform sampler2DMS windings;
float winding() { return texelFetch(windings, ivec2(gl_FragCoord.xy), gl_SampleID).r; }
#else
layout(binding = 9) uniform sampler2D windings;
float winding() { return texelFetch(windings, ivec2(gl_FragCoord.xy), 0).r; }
#endif
layout(location = 0) out vec4 colour;
void main() {
  float depth = dot(depth_of_plane, vec3(gl_FragCoord.xy, 1.0));
  if (winding() == 0.0 || !(depth >= 0.0)) discard;
  gl_FragDepth = depth;
  colour = vec4(cut_colour, 1.0);
  if (!(fog.w > 0.0)) return;
  vec2 at = (2.0 * gl_FragCoord.xy / size - 1.0) * lens.xy;
  float w = lens.z * lens.w / (lens.w - depth * (lens.w - lens.z));
  float share = exp(-fog.w * w * sqrt(1.0 + dot(at, at)));
  colour.rgb = share * cut_colour + (1.0 - share) * fog.rgb;
}
)";

}  // namespace

GlCuts::GlCuts(ImageSize size, int samples)
    : size_(size),
      samples_(samples),
      windings_(make_plane(GL_R32F, size, samples)),
      fill_(make_screen_program((samples > 1 ? "#define MULTISAMPLED\n" : "") + std::string(fill_source))) {
  check_memory("filling the cuts of solids");
  glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, windings_.name(), 0);
}

void GlCuts::draw(const Frame& frame, const std::vector<effects::CutFace>& faces, const GlScene& scene,
                  GlStream& stream, const std::function<void(const GlPipeline&)>& use, const GlTarget& target) {
  for (const effects::CutFace& face : faces) {
    count(frame, face, scene, stream, use);
    target.bind();
    const auto number = [](double v) { return static_cast<float>(v); };
    const auto& [x, y, at_corner] = face.depth;
    const Fog& fog = frame.settings.fog;
    const float density = face.model->effects.contains(Effect::fog) ? fog.density : 0;
    glBindTextureUnit(9, windings_.name());
    glUseProgram(fill_.name());
    // OpenGL's rows start at the bottom.
    glProgramUniform3f(fill_.name(), 0, number(x), number(-y), number(at_corner + y * size_.height));
    glProgramUniform3f(fill_.name(), 1, face.colour.x, face.colour.y, face.colour.z);
    glProgramUniform4f(fill_.name(), 2, fog.colour.x, fog.colour.y, fog.colour.z, density);
    glProgramUniform4f(fill_.name(), 3, frame.lens.tan_x, frame.lens.tan_y, frame.lens.near, frame.lens.far);
    glProgramUniform2f(fill_.name(), 4, number(size_.width), number(size_.height));
    draw_screen(nothing_);
    glBindTextureUnit(9, 0);
  }
}

void GlCuts::count(const Frame& frame, const effects::CutFace& face, const GlScene& scene, GlStream& stream,
                   const std::function<void(const GlPipeline&)>& use) {
  commands_.set(frame, scene, {GlPass::winding, &ModelFrame::solid, {face.model}}, stream);
  const std::array<float, 4> none{};
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, size_.width, size_.height);
  glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, none.data());
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  commands_.draw(scene, use);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

}  // namespace lodestone
