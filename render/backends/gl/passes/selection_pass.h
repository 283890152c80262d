// Selection on the device: select_cells of render/lod/selection.h by a compute shader, a cell an invocation, with the
// same decisions bit for bit.
//
// OpenGL promises correctly rounded sums, differences and products of floats, but not such a square root: the shader
// finds the rounded root itself (exact_root.h). Radii may belong to levels or to cells.
//
// The table of cells has the order in which select_cells visits them, so that the list has the same order, too. The
// decisions come back to the CPU, four bytes a cell, as it makes the draw commands.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "render/backends/gl/device/object.h"
#include "render/backends/gl/device/stream.h"
#include "render/frame/frame.h"

namespace lodestone {

class GlSelector {
 public:
  // Tables of the models, 36 bytes a cell. Throws UnsupportedError when the driver refuses the program.
  explicit GlSelector(std::span<const Hierarchy* const> models);

  // Does what select_cells does with the frustum of the model's view projection and its limits, culled cells left out;
  // Selection::visited is not counted. `stream` carries the shader's data of the frame. Waits for the device.
  void select(const ModelFrame& model, GlStream& stream, Selection& out);

 private:
  struct Node {
    Box3f bounds;
    std::uint32_t parent = 0;          // node; of the root: itself
    std::uint32_t cell_and_level = 0;  // level in the upper four bits
  };
  static_assert(sizeof(Node) == 32);
  struct Model {
    std::vector<CellId> cells;  // by node
    std::vector<std::uint8_t> levels;
    GlBuffer nodes, decisions, radii;
    std::vector<float> sent_radii;  // by cell; they are sent again when they have changed
  };
  static void send_radii(Model& model, const std::vector<float>& by_cell);
  [[nodiscard]] const GlProgram& program(DistanceMetric metric);

  std::vector<Model> models_;
  std::optional<GlProgram> programs_[distance_metric_count];
  std::vector<std::uint32_t> decisions_;
};

}  // namespace lodestone
