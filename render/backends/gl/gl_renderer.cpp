#include "render/backends/gl/gl_renderer.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <map>
#include <optional>

#include "core/base/error.h"
#include "render/backends/gl/gl_commands.h"
#include "render/backends/gl/gl_device.h"
#include "render/backends/gl/gl_scene.h"
#include "render/backends/gl/gl_shaders.h"
#include "render/backends/gl/gl_target.h"
#include "render/shading.h"

namespace lodestone {
namespace {

class Stopwatch {
 public:
  [[nodiscard]] double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

GlFrameUniforms frame_uniforms(const Frame& frame) {
  GlFrameUniforms u;
  for (std::size_t i = 0; i < 16; ++i) u.clip_rows[i / 4][i % 4] = frame.view_projection.m[i];
  const auto set = [](float* to, Vec3f v) {
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
  };
  set(u.viewpoint, frame.morph.viewpoint);
  set(u.light, frame.light);
  u.light[3] = shading::ambient;
  u.shading[0] = shading::least_norm2;
  const Radii& radii = *frame.morph.radii;
  for (std::size_t l = 0; l < radii.band_begin.size(); ++l) {
    u.levels[l].band_begin = radii.band_begin[l];
    u.levels[l].band_end = radii.band_end[l];
    set(u.levels[l].albedo, shading::albedo_of(static_cast<int>(l), frame.tint_by_level));
  }
  return u;
}

// The families that are there, those of a branch one after the other: cells selected together lie together.
std::vector<std::uint32_t> families_of(const Hierarchy& hierarchy) {
  std::vector<std::uint32_t> families;
  if (hierarchy.cells.empty()) return families;
  families.push_back(no_cell);
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const std::uint32_t parent = open.back();
    open.pop_back();
    const Cell& cell = hierarchy.cells[parent];
    if (cell.child_count == 0 || hierarchy.cells[cell.first_child].positions.empty()) continue;
    families.push_back(parent);
    for (std::uint32_t k = cell.child_count; k-- > 0;) open.push_back(cell.first_child + k);
  }
  return families;
}

// All that a picture depends on and that whoever shares the context may have changed.
void set_state() {
  for (const GLenum off : {GL_BLEND, GL_CULL_FACE, GL_DITHER, GL_FRAMEBUFFER_SRGB, GL_RASTERIZER_DISCARD,
                           GL_SCISSOR_TEST, GL_STENCIL_TEST})
    glDisable(off);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_MULTISAMPLE);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDepthRangef(0, 1);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

// Everything that has a name in the context.
struct Resources {
  std::map<GlVariant, GlProgram> programs;
  GlCommands commands;
  GlBuffer uniforms;
  GlTimer timer;
  std::optional<GlScene> scene;
  std::optional<GlTarget> target;
};

class MultiDrawRenderer final : public GlRenderer {
 public:
  MultiDrawRenderer(std::unique_ptr<GlContext> context, const GlConfig& config) : context_(std::move(context)) {
    const CurrentContext current(*context_);
    watch_errors();
    device_ = query_device();
    if (config.max_storage_block_bytes > 0)
      device_.max_storage_block_bytes = std::min(device_.max_storage_block_bytes, config.max_storage_block_bytes);
    resources_ = std::make_unique<Resources>();
  }

  ~MultiDrawRenderer() override {
    try {
      const CurrentContext current(*context_);
      resources_.reset();
    } catch (const ResourceError&) {
      // Another thread holds the context. What has a name in it ends with it; the owners must not call OpenGL here.
      (void)resources_.release();
    }
  }

  [[nodiscard]] std::string_view name() const override { return "gl"; }

  void upload(const Hierarchy& hierarchy) override {
    const CurrentContext current(*context_);
    resources_->scene.reset();  // before the new one: the device need not hold both
    resources_->scene.emplace(hierarchy, device_.max_storage_block_bytes, size_of_all(hierarchy));
    for (const std::uint32_t family : families_of(hierarchy)) resources_->scene->add(family);
  }

  void refresh(std::span<const std::uint32_t> went, std::span<const std::uint32_t> came) override {
    assert(resources_->scene);
    const CurrentContext current(*context_);
    for (const std::uint32_t family : went) resources_->scene->remove(family);
    for (const std::uint32_t family : came) resources_->scene->add(family);
  }

  FrameStats draw(const Frame& frame) override {
    check_frame(frame, device_.max_target_size);
    const CurrentContext current(*context_);
    const Stopwatch total;
    FrameStats stats;
    make_target(frame);
    prepare(frame, stats);

    const Stopwatch drawing;
    glBeginQuery(GL_TIME_ELAPSED, resources_->timer.name());
    set_state();
    resources_->target->bind();
    resources_->target->clear();
    resources_->commands.draw(*resources_->scene);
    resources_->target->average();
    glEndQuery(GL_TIME_ELAPSED);
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(resources_->timer.name(), GL_QUERY_RESULT, &nanoseconds);  // waits
    check_memory("drawing");

    // Frames of many triangles make llvmpipe forget when the query began; it then counts from the start of the machine.
    stats.milliseconds["gpu"] = std::min(static_cast<double>(nanoseconds) * 1e-6, drawing.milliseconds());
    stats.milliseconds["total"] = total.milliseconds();
    return stats;
  }

  [[nodiscard]] Image read_back() override {
    const CurrentContext current(*context_);
    return resources_->target ? resources_->target->read() : Image{};
  }

  [[nodiscard]] std::vector<Vec3f> capture(const Frame& frame) override {
    const CurrentContext current(*context_);
    FrameStats stats;
    prepare(frame, stats);
    std::vector<Vec3f> corners(static_cast<std::size_t>(3 * stats.triangles));
    if (corners.empty()) return corners;

    const auto bytes = static_cast<GLsizeiptr>(corners.size() * sizeof(Vec3f));
    const GlBuffer captured;
    const GlPrimitiveCounter written;
    glNamedBufferStorage(captured.name(), bytes, nullptr, 0);
    check_memory("capturing the drawn triangles");
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, captured.name());
    const GlFramebuffer nowhere;  // without a window there is none that could stay bound
    glNamedFramebufferParameteri(nowhere.name(), GL_FRAMEBUFFER_DEFAULT_WIDTH, 1);
    glNamedFramebufferParameteri(nowhere.name(), GL_FRAMEBUFFER_DEFAULT_HEIGHT, 1);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, nowhere.name());
    glEnable(GL_RASTERIZER_DISCARD);
    glBeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, written.name());
    glBeginTransformFeedback(GL_TRIANGLES);
    resources_->commands.draw(*resources_->scene);
    glEndTransformFeedback();
    glEndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
    glDisable(GL_RASTERIZER_DISCARD);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    GLuint64 triangles = 0;
    glGetQueryObjectui64v(written.name(), GL_QUERY_RESULT, &triangles);
    assert(triangles == stats.triangles);
    glGetNamedBufferSubData(captured.name(), 0, bytes, corners.data());
    return corners;
  }

  [[nodiscard]] std::size_t group_count() const override {
    return resources_->scene ? resources_->scene->group_count() : 0;
  }
  [[nodiscard]] std::string device() const override {
    return device_.renderer + ", " + device_.version + ", " + std::string(context_->origin());
  }

 private:
  // Program, uniforms and commands of the frame.
  void prepare(const Frame& frame, FrameStats& stats) {
    assert(resources_->scene && frame.morph.hierarchy == &resources_->scene->hierarchy());
    glUseProgram(program({frame.morph.blend, frame.morph.radii->metric, !frame.morph.limits.empty()}).name());
    const Stopwatch upload;
    const GlFrameUniforms uniforms = frame_uniforms(frame);
    glNamedBufferData(resources_->uniforms.name(), sizeof uniforms, &uniforms, GL_STREAM_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, frame_block, resources_->uniforms.name());
    resources_->commands.set(frame, *resources_->scene);
    stats.milliseconds["upload"] = upload.milliseconds();
    stats.cells = resources_->commands.cells();
    stats.triangles = resources_->commands.triangles();
  }

  void make_target(const Frame& frame) {
    std::optional<GlTarget>& target = resources_->target;
    if (target && target->size() == frame.size && target->samples() == frame.samples) return;
    target.reset();  // before the new one: the device need not hold both
    target.emplace(frame.size, frame.samples);
  }

  const GlProgram& program(GlVariant variant) {
    const auto found = resources_->programs.find(variant);
    if (found != resources_->programs.end()) return found->second;
    return resources_->programs.emplace(variant, make_draw_program(variant)).first->second;
  }

  std::unique_ptr<GlContext> context_;
  GlDevice device_;
  std::unique_ptr<Resources> resources_;
};

}  // namespace

std::unique_ptr<GlRenderer> make_gl_renderer(std::unique_ptr<GlContext> context, const GlConfig& config) {
  return std::make_unique<MultiDrawRenderer>(std::move(context), config);
}

std::unique_ptr<GlRenderer> make_gl_renderer(const GlConfig& config) {
  return make_gl_renderer(make_headless_context(), config);
}

}  // namespace lodestone
