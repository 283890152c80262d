// The interface of the rendering backends: upload once, draw frames, read pictures back.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/frame/frame.h"
#include "render/frame/image.h"

namespace lodestone {

// Throws InputError for a picture of no pixels or more than `largest_side` a side, for a number of samples that is
// neither 1 nor 4, and where a matrix, a viewpoint, a light or a parameter of an effect holds something that is not a
// finite number in its range. Backends call it before they draw.
void check_frame(const Frame& frame, int largest_side);

struct FrameStats {
  std::uint64_t cells = 0, triangles = 0;      // drawn
  std::uint64_t draw_calls = 0;                // that drew these; of a backend that makes any
  std::map<std::string, double> milliseconds;  // by stage, as the backend names them
  // Work of the effects: points shaded by each of them ("fog"), and the work of their passes ("shadow triangles").
  // Effects that were not called for are not listed.
  std::map<std::string, std::uint64_t> work;
  // Parts that are not drawn as the models have them ("texture ... cannot be decoded"), each in the first frame that
  // shows it.
  std::vector<std::string> warnings;
};

class Renderer {
 public:
  virtual ~Renderer() = default;
  [[nodiscard]] virtual std::string_view name() const = 0;
  // Replaces all models; ModelFrame::model numbers them. The hierarchies must outlive the renderer. Cells without
  // arrays are not loaded yet: refresh() adds them.
  virtual void upload(std::span<const Hierarchy* const> models) = 0;
  void upload(const Hierarchy& only) {
    const Hierarchy* const model = &only;
    upload(std::span(&model, 1));
  }
  // Since the last frame the arrays of these families, named as in core/hierarchy/lode/lode_payload.h, were removed and
  // added (ResidentCells::went, came).
  virtual void refresh(std::uint32_t /*model*/, std::span<const CellId> /*went*/, std::span<const CellId> /*came*/) {}
  // Throws InputError for a frame that check_frame refuses; the last picture is kept then.
  virtual FrameStats draw(const Frame& frame) = 0;
  // Picture of the last frame; empty for `null`, and before the first. Depth is that of the first sample.
  [[nodiscard]] virtual Image read_back() = 0;
};

}  // namespace lodestone
