#include "render/backends/gl/scene/commands.h"

#include <algorithm>

#include "render/lod/limits.h"

namespace lodestone {
namespace {

// The selection calls a cell static when lambda = 1 on its whole box by the CPU's distances. The shader's square root
// may be a few units in the last place off, and a vertex that it shares with a morphing cell must not move there: a
// cell is static here only with some room to the band.
bool is_static(const ModelFrame& model, const SelectedCell& selected) {
  if (selected.level == 0 || !model.effects.contains(Effect::geomorph)) return true;
  const Radii& radii = *model.morph.radii;
  if (!radii.by_cell.empty() && !radii.signatures) return true;  // lambda = 1
  if (selected.morphing) return false;
  if (!radii.by_cell.empty()) return true;  // by the CPU's lambdas
  const MorphContext& morph = model.morph;
  const Box3f& bounds = morph.hierarchy->cells[selected.cell].bounds;
  return limited_farthest_distance(radii.metric, morph.viewpoint, bounds, morph.limits) * (1 + rounding_guard) <
         radii.band_begin[selected.level];
}

}  // namespace

void GlCommands::set(const Frame& frame, const GlScene& scene, const GlGeometry& geometry, GlStream& stream) {
  commands_.clear();
  records_.clear();
  multi_draws_.clear();
  limits_.clear();
  lambdas_.clear();
  bucket_count_ = 0;
  cells_ = triangles_ = morphing_vertices_ = 0;
  sort_into_pipelines(frame, geometry);
  for (std::size_t p = 0; p < pipelines_.size(); ++p)
    for (const ModelFrame* model : pipelines_[p].models) {
      const auto instance = static_cast<std::uint32_t>(model - frame.models.data());
      if (by_signature_.size() <= instance) by_signature_.resize(instance + 1);
      by_signature_[instance].begin(model->morph);
      for (const SelectedCell& selected : (model->*geometry.selection)->cells)
        if (selected.visible) add(*model, instance, scene, selected, p);
    }
  for (std::size_t k = 0; k < bucket_count_; ++k) {
    Bucket& b = buckets_[k];
    const auto first = static_cast<std::uint32_t>(commands_.size()),
               first_record = static_cast<std::uint32_t>(records_.size());  // several commands share one
    multi_draws_.push_back({b.pipeline, b.group, first, static_cast<std::uint32_t>(b.commands.size())});
    for (GlDrawCommand& command : b.commands) command.base_instance += first_record;
    commands_.insert(commands_.end(), b.commands.begin(), b.commands.end());
    records_.insert(records_.end(), b.records.begin(), b.records.end());
  }
  sent_commands_ = stream.write(std::span<const GlDrawCommand>(commands_));
  sent_records_ = stream.write(std::span<const GlDrawRecord>(records_));
  sent_limits_ = stream.write(std::span<const GlLimit>(limits_));
  sent_lambdas_ = stream.write(std::span<const float>(lambdas_));
}

void GlCommands::sort_into_pipelines(const Frame& frame, const GlGeometry& geometry) {
  pipelines_.clear();
  for (const ModelFrame* model : geometry.models) {
    const GlVariant variant = variant_of(frame, *model, geometry.pass);
    auto found = std::ranges::find(pipelines_, variant, &GlPipeline::variant);
    if (found == pipelines_.end()) found = pipelines_.insert(found, {variant, {}, 0});
    found->models.push_back(model);
  }
}

// The order of the cells is kept, whatever room they have found: of triangles at the same depth the first is seen.
// Cells of a branch lie together: mostly it is the bucket of the cell before.
GlCommands::Bucket& GlCommands::bucket(std::size_t pipeline, std::uint32_t group) {
  if (bucket_count_ > 0)
    if (Bucket& last = buckets_[bucket_count_ - 1]; last.pipeline == pipeline && last.group == group) return last;
  if (bucket_count_ == buckets_.size()) buckets_.emplace_back();
  Bucket& made = buckets_[bucket_count_++];
  made.pipeline = pipeline;
  made.group = group;
  made.commands.clear();
  made.records.clear();
  return made;
}

void GlCommands::add(const ModelFrame& model, std::uint32_t instance, const GlScene& scene,
                     const SelectedCell& selected, std::size_t pipeline) {
  const Cell& cell = scene.hierarchy(model.model).cells[selected.cell];
  const CellPlace& place = scene.place(model.model, selected.cell);
  // The other share of the model has counted it.
  const bool counts = (pipelines_[pipeline].variant.material_bits & leaves_out_others) == 0;
  if (counts) ++cells_;
  const std::size_t triangles = drawn_triangles(cell, selected.ranges);
  if (triangles == 0) return;
  if (counts) triangles_ += triangles;
  pipelines_[pipeline].triangles += triangles;

  Bucket& b = bucket(pipeline, place.group);
  for_each_range(cell, selected.ranges, [&](TriangleRange range) {
    b.commands.push_back({3 * (range.end - range.begin), 1, place.first_index + 3 * range.begin,
                          static_cast<std::int32_t>(place.first_vertex), static_cast<std::uint32_t>(b.records.size())});
  });
  GlDrawRecord record{place.parent_first_vertex, selected.level | instance << instance_shift, 0, 0};
  if (!is_static(model, selected)) {
    morphing_vertices_ += cell.positions.size();
    record.bits |= morphs_bit;
    add_motion(model.morph, selected.cell, record);
  }
  b.records.push_back(record);
}

// Sends the lambdas of a cell, or the limits that they follow from.
void GlCommands::add_motion(const MorphContext& morph, CellId id, GlDrawRecord& record) {
  if (!morph.radii->by_cell.empty()) {
    record.first_limit = static_cast<std::uint32_t>(lambdas_.size());
    by_signature_[record.bits >> instance_shift].append(id, lambdas_);
    return;
  }
  record.first_limit = static_cast<std::uint32_t>(limits_.size());
  near_.clear();
  limits_near(morph.radii->metric, morph.viewpoint, morph.hierarchy->cells[id].bounds, morph.limits, near_);
  for (const DetailLimit& l : near_)
    limits_.push_back({{l.box.lo.x, l.box.lo.y, l.box.lo.z}, l.radius, {l.box.hi.x, l.box.hi.y, l.box.hi.z}, 0});
  record.end_limit = static_cast<std::uint32_t>(limits_.size());
}

void GlCommands::draw(const GlScene& scene, const std::function<void(const GlPipeline&)>& use) const {
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, sent_commands_.buffer);
  const GlPipeline* in_use = nullptr;
  for (const GlMultiDraw& multi : multi_draws_) {
    if (const GlPipeline* next = &pipelines_[multi.pipeline]; next != in_use) {
      use(*(in_use = next));
      (next->variant.given ? sent_lambdas_ : sent_limits_).bind(GL_SHADER_STORAGE_BUFFER, limits_block);
      if (next->variant.clipped) glEnable(GL_CLIP_DISTANCE0);
    }
    scene.bind(multi.group, sent_records_);
    const std::uintptr_t offset = static_cast<std::uintptr_t>(sent_commands_.offset) +
                                  std::uintptr_t{multi.first_command} * sizeof(GlDrawCommand);
    glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, reinterpret_cast<const void*>(offset),
                                static_cast<GLsizei>(multi.command_count), 0);
  }
  if (in_use && in_use->variant.clipped) glDisable(GL_CLIP_DISTANCE0);  // all models of a frame are, or none
}

}  // namespace lodestone
