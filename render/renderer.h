// The interface of the rendering backends: upload once, draw frames, read pictures back.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/hierarchy/hierarchy.h"
#include "parallel/scheduler.h"
#include "render/camera.h"
#include "render/image.h"
#include "render/lod/morph.h"
#include "render/lod/selection.h"

namespace lodestone {

// Everything that a frame depends on. The selection has been made; a backend draws its visible cells.
struct Frame {
  MorphContext morph;
  const Selection* selection = nullptr;
  ViewProjection view_projection;
  Vec3f light{0, 0, 1};  // unit, towards the light, normalised model space (a head light by default)
  ImageSize size;
  int samples = 1;  // a pixel: 1, or 4 averaged (multisampling: coverage and depth a sample, colour once a triangle)
  bool tint_by_level = false;
};

// Throws InputError for a picture of no pixels or more than `largest_side` a side, for a number of samples that is
// neither 1 nor 4, and where matrix, viewpoint or light hold something that is not a finite number. Backends call it
// before they draw.
void check_frame(const Frame& frame, int largest_side);

struct FrameStats {
  std::uint64_t cells = 0, triangles = 0;      // drawn
  std::map<std::string, double> milliseconds;  // by stage, as the backend names them
};

class Renderer {
 public:
  virtual ~Renderer() = default;
  [[nodiscard]] virtual std::string_view name() const = 0;
  // Keeps what it needs of the hierarchy; the hierarchy must outlive the renderer.
  // Cells without arrays are not there yet: they come by refresh().
  virtual void upload(const Hierarchy& hierarchy) = 0;
  // Since the last frame the arrays of these families, named as in core/hierarchy/family.h, have gone and come
  // (ResidentCells::went, came).
  virtual void refresh(std::span<const std::uint32_t> /*went*/, std::span<const std::uint32_t> /*came*/) {}
  // Throws InputError for a frame that check_frame refuses; the last picture is kept then.
  virtual FrameStats draw(const Frame& frame) = 0;
  // Picture of the last frame; empty for `null`, and before the first. Depth is that of the first sample.
  [[nodiscard]] virtual Image read_back() = 0;
};

// "soft", "gl", "null". Throws InputError for another name, UnsupportedError (with what is missing) when the backend
// cannot run here. The scheduler must outlive the renderer.
[[nodiscard]] std::unique_ptr<Renderer> make_renderer(std::string_view backend, Scheduler& scheduler);

}  // namespace lodestone
