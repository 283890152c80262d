// Occlusion culling on the device (render/culling/occlusion.h): the cells of a frame in two passes, the second to be
// drawn over the depth of the first. A compute shader finds the farthest depths of blocks of pixels; they alone come
// back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "render/backends/gl/device/object.h"
#include "render/backends/gl/device/target.h"
#include "render/culling/occlusion.h"

namespace lodestone {

class GlCulling {
 public:
  // Begins a frame, which must exist until its end. Returns for each of its models the visible cells, or parts of
  // them, that are drawn first.
  [[nodiscard]] const std::vector<Selection>& first(const Frame& frame);
  // To be called when those are drawn: returns the others that they do not hide. Waits for the device.
  [[nodiscard]] const std::vector<Selection>& second(const GlTarget& target);
  [[nodiscard]] bool has_second() const { return culling_.has_second(); }
  // To be called when all is drawn: notes what is hidden, for the next frame.
  void finish(const GlTarget& target);

  [[nodiscard]] std::size_t hidden_cells() const { return culling_.hidden_cells(); }    // that were not drawn
  [[nodiscard]] std::size_t divided_cells() const { return culling_.divided_cells(); }  // that both passes drew

 private:
  void find_depths(const GlTarget& target);
  [[nodiscard]] const std::vector<Selection>& select(std::span<const VisiblePart> parts);

  const Frame* frame_ = nullptr;
  OcclusionCulling culling_;
  std::vector<VisiblePart> visible_;
  std::vector<Selection> selected_;       // by model of the frame
  std::optional<GlProgram> programs_[2];  // for one sample a pixel, and for several
  GlBuffer blocks_;
  std::size_t block_room_ = 0;
};

}  // namespace lodestone
