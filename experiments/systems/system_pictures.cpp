#include "experiments/systems/system_pictures.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "core/base/error.h"

namespace lodestone {
namespace {

void add_up(const FrameStats& from, FrameStats& to) {
  to.cells += from.cells;
  to.triangles += from.triangles;
  to.draw_calls += from.draw_calls;
  for (const auto& [stage, milliseconds] : from.milliseconds) to.milliseconds[stage] += milliseconds;
  for (const auto& [what, count] : from.work) to.work[what] += count;
  to.warnings.insert(to.warnings.end(), from.warnings.begin(), from.warnings.end());
}

void check_parts(std::string_view name, const std::vector<SystemPart>& parts, std::size_t most) {
  double sum = 0;
  for (const SystemPart& part : parts) sum += part.share >= 0 ? part.share : 2;
  if (parts.empty() || parts.size() > most || !(std::abs(sum - 1) < 1e-6))
    throw InputError("the system " + std::string(name) + " gave " + std::to_string(parts.size()) + " parts; at most " +
                     std::to_string(most) + " are drawn, with shares that add up to 1");
}

// The patches that the frustum meets.
Selection in_sight(const SystemModel& model, const ViewProjection& projection) {
  const Frustum frustum = frustum_of(projection);
  Selection seen;
  for (const Selection* part : {&model.whole, &model.skirts})
    for (const SelectedCell& cell : part->cells)
      if (!is_outside(frustum, model.hierarchy->cells[cell.cell].bounds, 0)) seen.cells.push_back(cell);
  return seen;
}

}  // namespace

Image blended(const Image& a, const Image& b, double share) {
  assert(a.size == b.size && a.rgba.size() == b.rgba.size() && a.depth.size() == b.depth.size());
  Image image = a;
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    image.rgba[i] = static_cast<std::uint8_t>(std::lround((1 - share) * a.rgba[i] + share * b.rgba[i]));
  for (std::size_t i = 0; i < image.depth.size(); ++i) image.depth[i] = std::min(a.depth[i], b.depth[i]);
  return image;
}

std::uint64_t drawn_bytes(const SystemModel& model) {
  const auto index_bytes = [](const auto& view) {
    return view.size() * view.words * (view.is_short() ? sizeof(std::uint16_t) : sizeof(std::uint32_t));
  };
  std::uint64_t bytes = 0;
  for (const Selection* part : {&model.whole, &model.skirts})
    for (const SelectedCell& drawn : part->cells) {
      const Cell& cell = model.hierarchy->cells[drawn.cell];
      bytes += cell.positions.size_bytes() + cell.normals.size_bytes();
      bytes += index_bytes(cell.parents) + index_bytes(cell.triangles);
    }
  return bytes;
}

SystemPictures::SystemPictures(SceneView& scene, Renderer& renderer, Scheduler& scheduler, const SystemConfig& config)
    : scene_(scene), renderer_(renderer), scheduler_(scheduler), config_(config) {
  for (std::size_t m = 0; m < scene.model_count(); ++m)
    if (scene.limit_rate(m) > 0)
      throw InputError("LOD systems are compared on whole models; open the scene without a memory budget");
}

void SystemPictures::show(SceneView& view, bool remade) {
  if (shown_ == &view && !remade) return;
  view.upload(renderer_);
  shown_ = &view;
}

SystemPictures::OwnScene& SystemPictures::own_scene(std::string_view name, const LodSystem& system) {
  if (const auto known = own_.find(name); known != own_.end()) return known->second;
  OwnScene own;
  const CpuClock clock;
  std::vector<OpenModel> models;
  for (std::size_t m = 0; m < scene_.model_count(); ++m) {
    own.models.push_back(system.patches(scene_.hierarchy(m), scheduler_));
    models.push_back({&own.models.back()->hierarchy()});
  }
  own.time = clock.elapsed();
  own.view = std::make_unique<SceneView>(scene_.scene(), std::move(models));
  return own_.emplace(name, std::move(own)).first->second;
}

StageTime SystemPictures::prepare(std::string_view system) {
  return lod_system(system).patches ? own_scene(system, lod_system(system)).time : StageTime{};
}

SystemPicture SystemPictures::draw_patches(OwnScene& own, const Camera& camera, const ViewConfig& view) {
  if (view.radii.kappa0) throw InputError("patches follow a tolerance in pixels; give a pixel error instead of kappa0");
  ViewConfig config = view;
  config.radii.rule = RadiiRule::per_level;  // one level has no radii, by any rule
  (void)own.view->update(camera, config);
  const double reach = radius_over_error(for_picture(view.radii, view.size, camera.vertical_fov));

  SystemPicture picture;
  picture.models.resize(own.models.size());
  bool remade = false;
  Frame frame = own.view->frame();
  for (std::size_t m = 0; m < own.models.size(); ++m) {
    SystemModel& model = picture.models[m];
    MorphContext& morph = frame.models[m].morph;
    model = {.hierarchy = morph.hierarchy,
             .radii = without_morph(*morph.radii),
             .morph = without_morph(*morph.radii),
             .blend = morph.blend,
             .viewpoint = morph.viewpoint,
             .whole = {},
             .view_projection = frame.models[m].view_projection,
             .patches = own.models[m].get()};
    for (const CellId cell : own.models[m]->select(model.viewpoint, reach))
      (model.patches->is_skirt(cell) ? model.skirts : model.whole)
          .cells.push_back({.cell = cell, .level = 0, .visible = true, .morphing = false});
    morph.radii = &model.radii;
    remade = remade || model.patches->remakes();
  }
  show(*own.view, remade);
  draw_frame(
      frame, [&](std::size_t m, const ViewProjection& projection) { return in_sight(picture.models[m], projection); },
      picture);
  picture.image = renderer_.read_back();
  return picture;
}

// Draws a frame with the cells that `select` finds in sight of the camera, and of the light where that is asked for.
void SystemPictures::draw_frame(Frame& frame, const SelectInSight& select, SystemPicture& picture) {
  frame.select_on_device = false;
  std::vector<Selection> drawn(frame.models.size()), casters(frame.models.size());
  for (std::size_t m = 0; m < frame.models.size(); ++m) {
    ModelFrame& model = frame.models[m];
    drawn[m] = select(m, model.view_projection);
    model.selection = &drawn[m];
    if (!model.casters) continue;
    casters[m] = select(m, model.light_projection);
    model.casters = &casters[m];
  }
  add_up(renderer_.draw(frame), picture.stats);
}

// Draws the frame of the view with one of the parts of each model.
void SystemPictures::draw_part(const std::vector<std::vector<SystemPart>>& parts, std::size_t part,
                               SystemPicture& picture) {
  Frame frame = scene_.frame();
  for (std::size_t m = 0; m < parts.size(); ++m) {
    frame.models[m].morph.radii = &parts[m][part].radii;
    frame.models[m].morph.blend = parts[m][part].blend;
  }
  draw_frame(
      frame,
      [&](std::size_t m, const ViewProjection& projection) {
        const MorphContext& morph = frame.models[m].morph;
        const Frustum frustum = frustum_of(projection);
        Selection seen;
        select_cells(*morph.hierarchy, *morph.radii, morph.viewpoint, {&frustum, false}, seen);
        return seen;
      },
      picture);
}

SystemPicture SystemPictures::draw(std::string_view name, const Camera& camera, const ViewConfig& view) {
  const LodSystem& system = lod_system(name);
  if (system.blends && scene_.model_count() > 1)
    throw InputError("the system " + std::string(name) + " is made for one model; this scene has several");
  if (system.patches) return draw_patches(own_scene(name, system), camera, view);
  ViewConfig config = view;
  if (system.radii) config.radii.rule = *system.radii;
  show(scene_);
  (void)scene_.update(camera, config);

  SystemPicture picture;
  std::vector<std::vector<SystemPart>> parts;  // by model
  for (std::size_t m = 0; m < scene_.model_count(); ++m) {
    const ModelFrame& seen = scene_.frame().models[m];
    const MorphContext& morph = seen.morph;
    parts.push_back(system.parts({*morph.hierarchy, *morph.radii, morph.blend, morph.viewpoint, config_.fade_width}));
    check_parts(name, parts.back(), system.blends ? 2 : 1);
    SystemModel& model = picture.models.emplace_back();
    model.hierarchy = morph.hierarchy;
    model.morph = *morph.radii;
    model.radii = parts.back().front().radii;
    model.blend = parts.back().front().blend;
    model.viewpoint = morph.viewpoint;
    model.view_projection = seen.view_projection;
    select_cells(*model.hierarchy, model.radii, model.viewpoint, {}, model.whole);
  }
  draw_part(parts, 0, picture);
  picture.image = renderer_.read_back();
  if (parts.front().size() > 1) {
    draw_part(parts, 1, picture);
    picture.image = blended(picture.image, renderer_.read_back(), parts.front()[1].share);
    picture.pictures = 2;
  }
  return picture;
}

}  // namespace lodestone
