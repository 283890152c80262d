// The OpenGL 4.5 backend: the hierarchy is kept in the device's memory, and a frame is one indirect multi-draw.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "parallel/scheduler/scheduler.h"
#include "render/backends/gl/device/context.h"
#include "render/frame/renderer.h"

namespace lodestone {

struct GlConfig {
  // Bytes of the largest storage block; 0: what the driver allows. Smaller values cut the hierarchy into more groups,
  // one multi-draw each.
  std::size_t max_storage_block_bytes = 0;
  // Its workers decode textures; it must outlive the renderer. Null: the calling thread decodes them.
  Scheduler* scheduler = nullptr;
};

// FrameStats::milliseconds: "device select" (if requested, until its result has arrived), "culling" (with
// Frame::cull_occluded: finding hidden cells), "upload" (CPU time of the frame's draw commands, made and sent), "gpu"
// (the device, first clear to last pixel), of that "shadow", "transparency", "ambient occlusion" or "overdraw" where it
// has such a pass, "total" (wall time of draw, which returns when the picture is done).
class GlRenderer : public Renderer {
 public:
  // The morphed positions of the corners of all drawn triangles, three a triangle, by pipeline and group, as the vertex
  // shader computed them: the same program as draw's. For verifiers; makes no picture.
  [[nodiscard]] virtual std::vector<Vec3f> capture(const Frame& frame) = 0;

  // Copies the colours of the last picture into a framebuffer of the same context and at least its size, the upper row
  // first. Nothing happens before the first picture.
  virtual void copy_to(unsigned framebuffer) = 0;

  // The cells that the device selects for each model of the frame: those of select_cells within the frustum.
  [[nodiscard]] virtual std::vector<Selection> select(const Frame& frame) = 0;

  // Number of buffer sets of the hierarchy: the multi-draws of a frame that shows all of it.
  [[nodiscard]] virtual std::size_t group_count() const = 0;
  // "llvmpipe (...), 4.5 (Core Profile) ..., EGL surfaceless"
  [[nodiscard]] virtual std::string device() const = 0;
};

// Draws with the given context, or a headless one. Throws UnsupportedError naming the missing feature and the remedy.
[[nodiscard]] std::unique_ptr<GlRenderer> make_gl_renderer(std::unique_ptr<GlContext> context,
                                                           const GlConfig& config = {});
[[nodiscard]] std::unique_ptr<GlRenderer> make_gl_renderer(const GlConfig& config = {});

}  // namespace lodestone
