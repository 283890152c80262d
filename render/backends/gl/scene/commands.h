// The draw commands of a frame as glMultiDrawElementsIndirect reads them, with a record for each command.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "render/backends/gl/device/stream.h"
#include "render/backends/gl/scene/scene.h"
#include "render/backends/gl/shaders/draw_program.h"
#include "render/frame/renderer.h"

namespace lodestone {

// Layout fixed by OpenGL.
struct GlDrawCommand {
  std::uint32_t count = 0;  // indices
  std::uint32_t instance_count = 1;
  std::uint32_t first_index = 0;
  std::int32_t base_vertex = 0;
  std::uint32_t base_instance = 0;  // of the draw record
};

// The models that one program draws.
struct GlPipeline {
  GlVariant variant;
  std::vector<const ModelFrame*> models;
  std::uint64_t triangles = 0;
};

// Commands of one pipeline in one group: one multi-draw.
struct GlMultiDraw {
  std::size_t pipeline = 0;
  std::uint32_t group = 0;
  std::uint32_t first_command = 0, command_count = 0;
};

// The models of a frame that a pass draws, and the selection that it takes of each.
struct GlGeometry {
  GlPass pass = GlPass::picture;
  const Selection* ModelFrame::*selection = &ModelFrame::selection;  // its visible cells
  std::vector<const ModelFrame*> models;
};

class GlCommands {
 public:
  // Commands for the visible cells of the models' selections, sent to the device.
  void set(const Frame& frame, const GlScene& scene, const GlGeometry& geometry, GlStream& stream);
  // Draws them into whatever target is bound, in the order of pipelines(); calls use(pipeline) before each, which makes
  // its program current.
  void draw(const GlScene& scene, const std::function<void(const GlPipeline&)>& use) const;

  [[nodiscard]] std::uint64_t cells() const { return cells_; }
  [[nodiscard]] std::uint64_t triangles() const { return triangles_; }
  [[nodiscard]] std::span<const GlMultiDraw> multi_draws() const { return multi_draws_; }
  [[nodiscard]] std::uint64_t morphing_vertices() const { return morphing_vertices_; }

 private:
  struct Bucket {
    std::size_t pipeline = 0;
    std::uint32_t group = 0;
    std::vector<GlDrawCommand> commands;
    std::vector<GlDrawRecord> records;
  };
  void sort_into_pipelines(const Frame& frame, const GlGeometry& geometry);
  void add(const ModelFrame& model, std::uint32_t instance, const GlScene& scene, const SelectedCell& selected,
           std::size_t pipeline);
  void add_motion(const MorphContext& morph, CellId id, GlDrawRecord& record);
  Bucket& bucket(std::size_t pipeline, std::uint32_t group);

  std::vector<GlPipeline> pipelines_;
  std::vector<Bucket> buckets_;  // those in use first; the others keep their memory for later frames
  std::size_t bucket_count_ = 0;
  std::vector<GlDrawCommand> commands_;
  std::vector<GlDrawRecord> records_;
  std::vector<GlMultiDraw> multi_draws_;
  std::vector<DetailLimit> near_;
  std::vector<GlLimit> limits_;
  std::vector<float> lambdas_;
  std::vector<FrameLambdas> by_signature_;  // of the models
  GlRange sent_commands_, sent_records_, sent_limits_, sent_lambdas_;
  std::uint64_t cells_ = 0, triangles_ = 0, morphing_vertices_ = 0;
};

}  // namespace lodestone
