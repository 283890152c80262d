#include "render/backends/gl/passes/culling_pass.h"

#include <algorithm>
#include <string>

#include "render/backends/gl/device/device.h"
#include "render/backends/gl/device/program.h"

namespace lodestone {
namespace {

// Devices interpolate depth each in their way: so much farther everything counts that hides something.
constexpr float interpolation_guard = 1e-5f;

constexpr GLuint depth_unit = 11, blocks_block = 0;
constexpr GLint size_location = 0;

// A block a work group, a pixel an invocation. Rows of blocks count from the top of the picture, those of the texture
// from the bottom.
constexpr const char* pyramid_source = R"(
layout(local_size_x = 8, local_size_y = 8) in;
#ifdef SEVERAL
layout(binding = 11) uniform sampler2DMS depth;
#else
layout(binding = 11) uniform sampler2D depth;
#endif
layout(location = 0) uniform ivec2 size;
layout(std430, binding = 0) writeonly restrict buffer Blocks { float farthest[]; };
shared float of_pixel[64];

float farthest_at(ivec2 at) {
#ifdef SEVERAL
  float far = 0.0;
  for (int s = 0; s < textureSamples(depth); ++s) far = max(far, texelFetch(depth, at, s).r);
  return far;
#else
  return texelFetch(depth, at, 0).r;
#endif
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  uint own = gl_LocalInvocationIndex;
  of_pixel[own] = all(lessThan(at, size)) ? farthest_at(ivec2(at.x, size.y - 1 - at.y)) : 0.0;
  for (uint other = 32u; other > 0u; other >>= 1) {
    barrier();
    if (own < other) of_pixel[own] = max(of_pixel[own], of_pixel[own + other]);
  }
  if (own == 0u) farthest[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = of_pixel[0];
}
)";
static_assert(DepthPyramid::block_size == 8);

GlProgram make_program(bool several) {
  const GlStage stage{
      GL_COMPUTE_SHADER,
      std::string(several ? "#extension GL_ARB_shader_texture_image_samples : require\n#define SEVERAL\n" : "") +
          pyramid_source};
  return link_program(std::span(&stage, 1));
}

}  // namespace

const std::vector<Selection>& GlCulling::first(const Frame& frame) {
  frame_ = &frame;
  visible_.clear();
  for (std::uint32_t m = 0; m < frame.models.size(); ++m) {
    const std::vector<SelectedCell>& cells = frame.models[m].selection->cells;
    for (std::uint32_t k = 0; k < cells.size(); ++k)
      if (cells[k].visible) visible_.push_back({m, k, cells[k].cell, cells[k].level, cells[k].ranges});
  }
  return select(culling_.first(frame, visible_));
}

const std::vector<Selection>& GlCulling::select(std::span<const VisiblePart> parts) {
  selected_.resize(frame_->models.size());
  for (Selection& selection : selected_) selection.cells.clear();
  for (const VisiblePart& part : parts) {
    SelectedCell cell = frame_->models[part.model].selection->cells[part.number];
    cell.ranges = part.ranges;
    selected_[part.model].cells.push_back(cell);
  }
  return selected_;
}

void GlCulling::find_depths(const GlTarget& target) {
  DepthPyramid& pyramid = culling_.pyramid();
  const std::span<float> blocks = pyramid.blocks();
  if (blocks.size() > block_room_) {
    blocks_ = GlBuffer();
    glNamedBufferStorage(blocks_.name(), static_cast<GLsizeiptr>(blocks.size_bytes()), nullptr, 0);
    check_memory("culling what is hidden");
    block_room_ = blocks.size();
  }
  std::optional<GlProgram>& program = programs_[target.samples() > 1];
  if (!program) program = make_program(target.samples() > 1);
  glUseProgram(program->name());
  glUniform2i(size_location, target.size().width, target.size().height);
  glBindTextureUnit(depth_unit, target.drawn_depth());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, blocks_block, blocks_.name());
  glDispatchCompute(static_cast<GLuint>(pyramid.columns()), static_cast<GLuint>(pyramid.rows()), 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(blocks_.name(), 0, static_cast<GLsizeiptr>(blocks.size_bytes()), blocks.data());
  for (float& farthest : blocks) farthest = std::min(farthest + interpolation_guard, 1.0f);
}

const std::vector<Selection>& GlCulling::second(const GlTarget& target) {
  find_depths(target);
  return select(culling_.second());
}

void GlCulling::finish(const GlTarget& target) {
  if (has_second()) find_depths(target);
  culling_.finish();
}

}  // namespace lodestone
