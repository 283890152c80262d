#include "render/backends/gl/gl_renderer.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <optional>

#include "core/base/error.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/gl/device/device.h"
#include "render/backends/gl/device/target.h"
#include "render/backends/gl/device/timed_sections.h"
#include "render/backends/gl/passes/ambient_occlusion_pass.h"
#include "render/backends/gl/passes/capture_pass.h"
#include "render/backends/gl/passes/culling_pass.h"
#include "render/backends/gl/passes/cut_pass.h"
#include "render/backends/gl/passes/layers_pass.h"
#include "render/backends/gl/passes/overdraw_pass.h"
#include "render/backends/gl/passes/selection_pass.h"
#include "render/backends/gl/passes/shadow_pass.h"
#include "render/backends/gl/scene/commands.h"
#include "render/backends/gl/scene/scene.h"
#include "render/backends/gl/scene/textures.h"
#include "render/backends/gl/shaders/draw_program.h"
#include "render/culling/runs.h"
#include "render/effects/ambient_occlusion.h"
#include "render/effects/overdraw.h"
#include "render/effects/shadow.h"
#include "render/effects/transparency.h"

namespace lodestone {
namespace {

// The loaded families, those of a branch one after the other: cells selected together lie together.
std::vector<CellId> families_of(const Hierarchy& hierarchy) {
  std::vector<CellId> families;
  if (hierarchy.cells.empty()) return families;
  families.push_back(no_cell);
  std::vector<CellId> open{CellId(0)};
  while (!open.empty()) {
    const CellId parent = open.back();
    open.pop_back();
    const Cell& cell = hierarchy.cells[parent];
    if (cell.child_count == 0 || hierarchy.cells[cell.first_child].positions.empty()) continue;
    families.push_back(parent);
    for (std::uint32_t k = cell.child_count; k-- > 0;) open.emplace_back(cell.first_child + k);
  }
  return families;
}

// Sets all state that a picture depends on and that other users of the context may have changed.
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
  glFrontFace(GL_CCW);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

// Everything that has a name in the context.
struct Resources {
  std::map<GlVariant, GlProgram> programs;
  GlCommands commands;
  GlStream stream;
  std::optional<GlSelector> selector;  // made when first used
  GlSections sections;
  std::optional<GlShadow> shadow;  // passes: made when first used
  std::optional<GlOverdraw> overdraw;
  GlCulling culling;
  std::optional<GlCuts> cuts;
  std::optional<GlLayers> layers;
  std::optional<GlOcclusion> occlusion;
  std::optional<GlScene> scene;
  GlTextures textures;
  std::optional<GlTarget> target;
};

class MultiDrawRenderer final : public GlRenderer {
 public:
  MultiDrawRenderer(std::unique_ptr<GlContext> context, const GlConfig& config)
      : context_(std::move(context)), scheduler_(config.scheduler) {
    const CurrentContext current(*context_);
    watch_errors();
    device_ = query_device();
    if (config.max_storage_block_bytes > 0)
      device_.max_storage_block_bytes = std::min(device_.max_storage_block_bytes, config.max_storage_block_bytes);
    if (!scheduler_) scheduler_ = (own_scheduler_ = make_serial_scheduler()).get();
    resources_ = std::make_unique<Resources>();
  }

  ~MultiDrawRenderer() override {
    try {
      const CurrentContext current(*context_);
      resources_.reset();
    } catch (const ResourceError&) {
      // Another thread holds the context. Its objects end with it; their owners must not call OpenGL here.
      (void)resources_.release();
    }
  }

  [[nodiscard]] std::string_view name() const override { return "gl"; }

  using Renderer::upload;
  void upload(std::span<const Hierarchy* const> models) override {
    const CurrentContext current(*context_);
    resources_->scene.reset();  // before the new one: the device need not hold both
    resources_->selector.reset();
    models_.assign(models.begin(), models.end());
    std::vector<GroupSize> expected;
    for (const Hierarchy* model : models) expected.push_back(size_of_all(*model));
    resources_->scene.emplace(models, device_.max_storage_block_bytes, expected);
    resources_->textures.set_models(models);
    for (std::uint32_t m = 0; m < models.size(); ++m)
      for (const CellId family : families_of(*models[m])) resources_->scene->add({m, family});
  }

  void refresh(std::uint32_t model, std::span<const CellId> went, std::span<const CellId> came) override {
    assert(resources_->scene);
    const CurrentContext current(*context_);
    for (const CellId family : went) resources_->scene->remove({model, family});
    for (const CellId family : came) resources_->scene->add({model, family});
  }

  FrameStats draw(const Frame& frame) override {
    check_frame(frame, device_.max_target_size);
    const CurrentContext current(*context_);
    const Stopwatch total;
    FrameStats stats;
    make_target(frame);
    resources_->stream.next_frame();
    if (frame.select_on_device) {
      Frame selected = frame;
      const Stopwatch selecting;
      selections_ = select_all(frame);
      ranges_.resize(selections_.size());
      for (std::size_t m = 0; m < selected.models.size(); ++m) {
        ModelFrame& model = selected.models[m];
        if (model.runs)
          model.runs->cull(*model.morph.hierarchy, model.view_projection, frame.size, selections_[m], ranges_[m]);
        model.selection = &selections_[m];
      }
      stats.milliseconds["device select"] = selecting.milliseconds();
      draw_selected(selected, stats);
    } else {
      draw_selected(frame, stats);
    }
    stats.milliseconds["total"] = total.milliseconds();
    return stats;
  }

  [[nodiscard]] Image read_back() override {
    const CurrentContext current(*context_);
    return resources_->target ? resources_->target->read() : Image{};
  }

  void copy_to(unsigned framebuffer) override {
    const CurrentContext current(*context_);
    if (resources_->target) resources_->target->copy_to(framebuffer);
  }

  [[nodiscard]] std::vector<Vec3f> capture(const Frame& frame) override {
    const CurrentContext current(*context_);
    FrameStats stats;
    Frame plain = frame;  // effects with a geometry stage do not move vertices
    for (ModelFrame& model : plain.models) model.effects.erase(Effect::wireframe);
    resources_->stream.next_frame();
    prepare(plain, stats);
    return capture_triangles(resources_->commands, *resources_->scene, use_program());
  }

  [[nodiscard]] std::vector<Selection> select(const Frame& frame) override {
    const CurrentContext current(*context_);
    resources_->stream.next_frame();
    return select_all(frame);
  }

  [[nodiscard]] std::size_t group_count() const override {
    return resources_->scene ? resources_->scene->group_count() : 0;
  }
  [[nodiscard]] std::string device() const override {
    return device_.renderer + ", " + device_.version + ", " + std::string(context_->origin());
  }

 private:
  void draw_selected(const Frame& frame, FrameStats& stats) {
    const Stopwatch drawing;
    set_state();
    if (frame.culls_occluded()) {
      draw_in_two_parts(frame, stats);
    } else {
      prepare(frame, stats);
      if (effects::counts_overdraw(frame)) {
        draw_overdraw(frame, stats);
      } else {
        draw_picture(frame, stats);
        finish_picture(frame, stats);
      }
    }
    resources_->sections.begin("picture");
    resources_->target->average();
    if (!effects::counts_overdraw(frame) && effects::has_occlusion_pass(frame)) draw_occlusion(frame, stats);
    resources_->sections.end();
    double sum = 0;
    for (const auto& [name, milliseconds] : resources_->sections.results(drawing.milliseconds())) {
      if (name != "picture") stats.milliseconds[name] = milliseconds;
      sum += milliseconds;
    }
    check_memory("drawing");
    stats.milliseconds["gpu"] = std::min(sum, drawing.milliseconds());
  }

  [[nodiscard]] std::vector<Selection> select_all(const Frame& frame) {
    if (!resources_->selector) resources_->selector.emplace(models_);
    std::vector<Selection> selections(frame.models.size());
    for (std::size_t m = 0; m < selections.size(); ++m)
      resources_->selector->select(frame.models[m], resources_->stream, selections[m]);
    return selections;
  }

  // Program, uniforms and commands of the frame.
  void prepare(const Frame& frame, FrameStats& stats) {
    assert(resources_->scene);
    const Stopwatch upload;
    const GlFrameUniforms uniforms = uniforms_of(frame);
    GlStream& stream = resources_->stream;
    stream.write(std::span(&uniforms, 1)).bind(GL_UNIFORM_BUFFER, frame_block);
    instances_.clear();
    for (const ModelFrame& model : frame.models) {
      assert(model.model < resources_->scene->model_count() &&
             model.morph.hierarchy == &resources_->scene->hierarchy(model.model));
      if (const auto& signatures = model.morph.radii->signatures)
        resources_->scene->set_signatures(model.model, signatures);
      instances_.push_back(instance_of(model, resources_->textures.first_material(model.model)));
    }
    if (const std::size_t decoded = resources_->textures.prepare(frame, *scheduler_))
      stats.work["decoded textures"] = decoded;
    stats.warnings = resources_->textures.take_warnings();
    resources_->textures.bind();
    stream.write(std::span<const GlInstance>(instances_)).bind(GL_SHADER_STORAGE_BUFFER, instances_block);
    GlGeometry geometry{effects::counts_overdraw(frame) ? GlPass::count : GlPass::picture, &ModelFrame::selection, {}};
    for (const ModelFrame& model : frame.models)
      if (geometry.pass == GlPass::count || !effects::is_transparent(frame, model)) geometry.models.push_back(&model);
    resources_->commands.set(frame, *resources_->scene, geometry, stream);
    stats.milliseconds["upload"] += upload.milliseconds();
    stats.cells += resources_->commands.cells();
    stats.triangles += resources_->commands.triangles();
    stats.draw_calls += resources_->commands.multi_draws().size();
  }

  void draw_picture(const Frame& frame, FrameStats& stats) {
    if (effects::has_shadow_pass(frame)) draw_shadow(frame, stats);
    resources_->sections.begin("picture");
    resources_->target->bind();
    resources_->target->clear(frame.settings.background);
    resources_->commands.draw(*resources_->scene, use_program());
  }

  // Draws cuts and layers over the opaque surfaces, once all of these are drawn.
  void finish_picture(const Frame& frame, FrameStats& stats) {
    draw_cuts(frame);
    const auto layered = [&](const ModelFrame& m) { return effects::has_layers(frame, m); };
    if (std::ranges::any_of(frame.models, layered)) draw_layers(frame, stats);
  }

  void draw_in_two_parts(const Frame& frame, FrameStats& stats) {
    GlCulling& culling = resources_->culling;
    Frame part = frame;
    const auto take = [&](const std::vector<Selection>& selections) {
      for (std::size_t m = 0; m < selections.size(); ++m) part.models[m].selection = &selections[m];
      prepare(part, stats);
    };
    take(culling.first(frame));
    draw_picture(part, stats);
    resources_->sections.begin("culling");
    const std::vector<Selection>& second = culling.second(*resources_->target);
    if (culling.has_second()) {
      resources_->sections.begin("picture");
      take(second);
      resources_->target->bind();
      resources_->commands.draw(*resources_->scene, use_program());
      resources_->sections.begin("culling");
    }
    finish_picture(frame, stats);
    culling.finish(*resources_->target);
    stats.cells -= culling.divided_cells();
    if (culling.hidden_cells() > 0) stats.work["hidden cells"] = culling.hidden_cells();
  }

  void draw_cuts(const Frame& frame) {
    const std::vector<effects::CutFace> faces = effects::cut_faces(frame);
    if (faces.empty()) return;
    resources_->sections.begin("cuts");
    std::optional<GlCuts>& cuts = resources_->cuts;
    if (!cuts || !cuts->fits(frame.size, frame.samples)) cuts.emplace(frame.size, frame.samples);
    cuts->draw(frame, faces, *resources_->scene, resources_->stream, use_program(), *resources_->target);
  }

  void draw_layers(const Frame& frame, FrameStats& stats) {
    resources_->sections.begin("transparency");
    std::optional<GlLayers>& layers = resources_->layers;
    if (!layers || !layers->fits(frame.size, frame.samples))
      layers.emplace(frame.size, frame.samples, device_.max_storage_block_bytes);
    layers->draw(frame, *resources_->scene, resources_->stream, use_program(), *resources_->target,
                 effects::has_occlusion_pass(frame));
    stats.cells += layers->commands().cells();
    stats.triangles += layers->commands().triangles();
    stats.draw_calls += layers->commands().multi_draws().size();
    if (layers->fragments() > 0) stats.work["transparency"] = layers->fragments();
  }

  void draw_shadow(const Frame& frame, FrameStats& stats) {
    resources_->sections.begin("shadow");
    const int texels = frame.settings.lighting.directional.shadow_texels;
    if (!resources_->shadow || resources_->shadow->texels() != texels) resources_->shadow.emplace(texels);
    resources_->shadow->draw(frame, *resources_->scene, resources_->stream, use_program());
    stats.work["shadow triangles"] = resources_->shadow->triangles();
  }

  void draw_occlusion(const Frame& frame, FrameStats& stats) {
    resources_->sections.begin("ambient occlusion");
    if (!resources_->occlusion) resources_->occlusion.emplace();
    resources_->occlusion->draw(frame, *resources_->target);
    stats.work["occlusion pixels"] = std::uint64_t{1} * frame.size.width * frame.size.height;
  }

  void draw_overdraw(const Frame& frame, FrameStats& stats) {
    resources_->sections.begin("overdraw");
    resources_->target->clear(frame.settings.background);
    std::optional<GlOverdraw>& overdraw = resources_->overdraw;
    if (!overdraw || overdraw->size() != frame.size) overdraw.emplace(frame.size);
    stats.work["covered samples"] =
        overdraw->draw(resources_->commands, *resources_->scene, use_program(), *resources_->target);
  }

  std::function<void(const GlPipeline&)> use_program() {
    return [this](const GlPipeline& pipeline) { glUseProgram(program(pipeline.variant).name()); };
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
  std::unique_ptr<Scheduler> own_scheduler_;
  Scheduler* scheduler_;
  std::vector<const Hierarchy*> models_;
  std::vector<GlInstance> instances_;
  std::vector<Selection> selections_;               // made on the device
  std::vector<std::vector<TriangleRange>> ranges_;  // of those
};

}  // namespace

std::unique_ptr<GlRenderer> make_gl_renderer(std::unique_ptr<GlContext> context, const GlConfig& config) {
  return std::make_unique<MultiDrawRenderer>(std::move(context), config);
}

std::unique_ptr<GlRenderer> make_gl_renderer(const GlConfig& config) {
  return make_gl_renderer(make_headless_context(), config);
}

}  // namespace lodestone
