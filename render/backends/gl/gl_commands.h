// The draw commands of a frame: what glMultiDrawElementsIndirect reads, and a record beside each command.
#pragma once

#include <cstdint>
#include <vector>

#include "render/backends/gl/gl_scene.h"
#include "render/backends/gl/gl_shaders.h"
#include "render/renderer.h"

namespace lodestone {

// Layout fixed by OpenGL.
struct GlDrawCommand {
  std::uint32_t count = 0;  // indices
  std::uint32_t instance_count = 1;
  std::uint32_t first_index = 0;
  std::int32_t base_vertex = 0;
  std::uint32_t base_instance = 0;  // of the draw record
};

// Consecutive commands of one group: one multi-draw.
struct GlMultiDraw {
  std::uint32_t group = 0;
  std::uint32_t first_command = 0, command_count = 0;
};

class GlCommands {
 public:
  // Commands for the visible cells of the frame's selection, sent to the device. Buffers are orphaned, so that a frame
  // that is still being drawn keeps its own.
  void set(const Frame& frame, const GlScene& scene);
  // Draws them with whatever program and target are bound.
  void draw(const GlScene& scene) const;

  [[nodiscard]] std::uint64_t cells() const { return cells_; }
  [[nodiscard]] std::uint64_t triangles() const { return triangles_; }

 private:
  void add(const Frame& frame, const GlScene& scene, const SelectedCell& selected);

  std::vector<GlDrawCommand> commands_;
  std::vector<GlDrawRecord> records_;
  std::vector<GlMultiDraw> multi_draws_;
  std::vector<DetailLimit> near_;
  std::vector<GlLimit> limits_;
  GlBuffer command_buffer_, record_buffer_, limit_buffer_;
  std::uint64_t cells_ = 0, triangles_ = 0;
};

}  // namespace lodestone
