#include "render/backends/gl/passes/shadow_pass.h"

#include "render/backends/gl/device/device.h"

namespace lodestone {

GlShadow::GlShadow(int texels) : texels_(texels) {
  glTextureStorage2D(depth_.name(), 1, GL_DEPTH_COMPONENT32F, texels, texels);
  check_memory("making the shadow map");
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTextureParameteri(depth_.name(), filter, GL_NEAREST);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTextureParameteri(depth_.name(), wrap, GL_CLAMP_TO_EDGE);
  glNamedFramebufferTexture(framebuffer_.name(), GL_DEPTH_ATTACHMENT, depth_.name(), 0);
  glNamedFramebufferDrawBuffer(framebuffer_.name(), GL_NONE);
}

void GlShadow::draw(const Frame& frame, const GlScene& scene, GlStream& stream,
                    const std::function<void(const GlPipeline&)>& use) {
  GlGeometry geometry{GlPass::shadow, &ModelFrame::casters, {}};
  for (const ModelFrame& model : frame.models)
    if (model.casters) geometry.models.push_back(&model);
  commands_.set(frame, scene, geometry, stream);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, texels_, texels_);
  const float farthest = 1;
  glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &farthest);
  commands_.draw(scene, use);
  glBindTextureUnit(shadow_unit, depth_.name());
}

}  // namespace lodestone
