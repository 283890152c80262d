#include "render/backends/gl/passes/shadow_pass.h"

#include <array>

#include "render/backends/gl/device/device.h"
#include "render/effects/transparency.h"

namespace lodestone {
namespace {

void make_map(const GlTexture& texture, GLenum format, int texels) {
  glTextureStorage2D(texture.name(), 1, format, texels, texels);
  check_memory("making the shadow map");
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTextureParameteri(texture.name(), filter, GL_NEAREST);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTextureParameteri(texture.name(), wrap, GL_CLAMP_TO_EDGE);
}

}  // namespace

GlShadow::Layers::Layers(int texels, const GlTexture& depth) {
  make_map(first, GL_R32F, texels);
  make_map(through, GL_R32F, texels);
  glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, through.name(), 0);
  glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT1, first.name(), 0);
  glNamedFramebufferTexture(framebuffer.name(), GL_DEPTH_ATTACHMENT, depth.name(), 0);
  const std::array<GLenum, 2> buffers{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glNamedFramebufferDrawBuffers(framebuffer.name(), static_cast<GLsizei>(buffers.size()), buffers.data());
}

GlShadow::GlShadow(int texels) : texels_(texels) {
  make_map(depth_, GL_DEPTH_COMPONENT32F, texels);
  make_map(no_layers_, GL_R32F, 1);
  glNamedFramebufferTexture(framebuffer_.name(), GL_DEPTH_ATTACHMENT, depth_.name(), 0);
  glNamedFramebufferDrawBuffer(framebuffer_.name(), GL_NONE);
}

void GlShadow::draw(const Frame& frame, const GlScene& scene, GlStream& stream,
                    const std::function<void(const GlPipeline&)>& use) {
  GlGeometry opaque{GlPass::shadow, &ModelFrame::casters, {}}, layers{GlPass::shadow_layers, &ModelFrame::casters, {}};
  for (const ModelFrame& model : frame.models) {
    if (!model.casters) continue;
    if (!effects::is_transparent(frame, model)) opaque.models.push_back(&model);
    if (effects::has_layers(frame, model)) layers.models.push_back(&model);
  }
  commands_.set(frame, scene, opaque, stream);
  triangles_ = commands_.triangles();
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, texels_, texels_);
  const float farthest = 1;
  glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &farthest);
  commands_.draw(scene, use);
  glBindTextureUnit(shadow_unit, depth_.name());
  const bool layered = !layers.models.empty();
  if (layered) {
    commands_.set(frame, scene, layers, stream);
    triangles_ += commands_.triangles();
    draw_layers(scene, use);
  }
  glBindTextureUnit(shadow_first_unit, layered ? layers_->first.name() : no_layers_.name());
  glBindTextureUnit(shadow_through_unit, layered ? layers_->through.name() : no_layers_.name());
}

// In any order: shares are multiplied, and of the depths the smallest is kept.
void GlShadow::draw_layers(const GlScene& scene, const std::function<void(const GlPipeline&)>& use) {
  if (!layers_) layers_.emplace(texels_, depth_);
  const std::array<float, 4> nothing{1, 1, 1, 1};
  for (const GLint plane : {0, 1})
    glClearNamedFramebufferfv(layers_->framebuffer.name(), GL_COLOR, plane, nothing.data());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, layers_->framebuffer.name());
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendEquationi(0, GL_FUNC_ADD);
  glBlendFunci(0, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
  glBlendEquationi(1, GL_MIN);
  commands_.draw(scene, use);
  glBlendEquation(GL_FUNC_ADD);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

}  // namespace lodestone
