#include "render/scene/scene_view.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/hierarchy/model/find_signatures.h"
#include "core/mesh/up_axis.h"
#include "render/camera/light_view.h"
#include "render/camera/placement.h"
#include "render/camera/view.h"
#include "render/frame/appearance.h"

namespace lodestone {
namespace {

// Wider cameras have near planes that reach far to the sides, where backs might be seen.
constexpr double widest_culled = 2.6;  // radians

const Selection no_cells;

// In units of the model's normalised space.
Plane in_model_space(const ClipPlane& plane, const Similarity& placement) {
  const double unit = length(plane.normal) * placement.scale;
  const double offset = dot(plane.normal, placement.translation) - plane.offset;
  return {to_float((1 / length(plane.normal)) * placement.rotated_back(plane.normal)),
          static_cast<float>(offset / unit)};
}

}  // namespace

ViewConfig view_config(const Scene& scene, ImageSize size) {
  return {.size = size,
          .radii = scene.radii,
          .blend = scene.blend,
          .settings = scene.settings,
          .effects = scene.effects,
          .towards_light = scene.towards_light,
          .hidden = {},
          .clip = {},
          .closed = {}};
}

SceneView::SceneView(const Scene& scene, std::vector<OpenModel> models) : scene_(scene) {
  assert(models.size() == scene.models.size());
  std::uint32_t uploaded = 0;
  for (std::size_t m = 0; m < models.size(); ++m) {
    Placed placed;
    placed.open = models[m];
    const Hierarchy& hierarchy = *models[m].hierarchy;
    if (hierarchy.cells.empty()) throw InputError(describe(scene.models[m].name, {}, "has nothing to draw"));
    placed.placement = placement_of(scene.models[m], hierarchy);
    placed.appearance = appearance_of(hierarchy, scene.models[m].appearance);
    if (scene.models[m].colour) placed.appearance.base_colour = *scene.models[m].colour;
    // A model with several placements is uploaded once.
    const auto same = std::ranges::find(placed_, models[m].hierarchy, [](const Placed& p) { return p.open.hierarchy; });
    placed.uploaded = same == placed_.end() ? uploaded++ : same->uploaded;
    placed_.push_back(std::move(placed));
  }
  place_models();
  frame_.models.resize(placed_.size());
}

// Chooses units in which single precision suffices for the models before the camera. A single model is drawn in its
// normalised space: the numbers are those of its hierarchy, wherever it is placed.
void SceneView::place_models() {
  if (placed_.size() == 1) {
    origin_ = placed_.front().placement.translation;
    unit_ = placed_.front().placement.scale;
  } else {
    const Sphere sphere = bounding_sphere();
    origin_ = sphere.centre;
    unit_ = 2 * sphere.radius;
  }
  for (Placed& placed : placed_)
    placed.in_picture = {placed.placement.rotation, placed.placement.scale / unit_,
                         (1 / unit_) * (placed.placement.translation - origin_)};
}

Sphere SceneView::bounding_sphere() const {
  const auto sphere_of = [](const Placed& placed) {
    const Box3f& box = placed.open.hierarchy->cells.front().bounds;
    const Vec3d lo = to_double(box.lo), hi = to_double(box.hi);
    return Sphere{placed.placement(0.5 * (lo + hi)), std::max(0.5 * length(hi - lo), 1e-6) * placed.placement.scale};
  };
  if (placed_.size() == 1) return sphere_of(placed_.front());
  Vec3d lo = sphere_of(placed_.front()).centre, hi = lo;
  for (const Placed& placed : placed_) {
    const auto [centre, r] = sphere_of(placed);
    lo = {std::min(lo.x, centre.x - r), std::min(lo.y, centre.y - r), std::min(lo.z, centre.z - r)};
    hi = {std::max(hi.x, centre.x + r), std::max(hi.y, centre.y + r), std::max(hi.z, centre.z + r)};
  }
  Sphere all{0.5 * (lo + hi), 0};
  for (const Placed& placed : placed_) {
    const Sphere one = sphere_of(placed);
    all.radius = std::max(all.radius, length(one.centre - all.centre) + one.radius);
  }
  return all;
}

Vec3d SceneView::up() const {
  if (scene_.up) return direction_of(*scene_.up, bounding_sphere().centre);
  const Placed& first = placed_.front();
  return first.placement.rotated(up_of(*first.open.hierarchy));
}

std::vector<const Hierarchy*> SceneView::uploaded() const {
  std::vector<const Hierarchy*> models;
  for (const Placed& placed : placed_)
    if (placed.uploaded == models.size()) models.push_back(placed.open.hierarchy);
  return models;
}

void SceneView::upload(Renderer& renderer) {
  renderer.upload(uploaded());
  for (Placed& placed : placed_) placed.went.clear(), placed.came.clear();
}

void SceneView::freeze(bool frozen) {
  frozen_ = frozen;
  camera_.reset();
}

// Adds loaded cells and requests missing ones; true if that changes the frame.
bool SceneView::stream(Placed& placed, const ModelFrame& model, const Camera& camera,
                       std::span<const ViewConfig> beside) {
  ResidentCells& resident = *placed.open.resident;
  // A cell that is limited for the largest radius of a level is limited for all views. These ask for the same, so that
  // none undoes what another has settled.
  Radii largest = placed.radii;
  for (const ViewConfig& other : beside) {
    const Radii radii = make_radii(resident.hierarchy(), for_picture(other.radii, other.size, camera.vertical_fov));
    if (!largest.by_cell.empty() || !radii.by_cell.empty()) {
      std::vector<float> by_cell;
      for (std::size_t l = 0; l < radii.select.size(); ++l)
        for (CellId c = resident.hierarchy().levels[l].first_cell; c < resident.hierarchy().levels[l].end_cell(); ++c)
          by_cell.push_back(std::max(largest.of(c, l), radii.of(c, l)));
      largest.by_cell = std::move(by_cell);
    }
    for (std::size_t l = 0; l < radii.select.size(); ++l) {
      largest.select[l] = std::max(largest.select[l], radii.select[l]);
      largest.band_begin[l] = std::min(largest.band_begin[l], radii.band_begin[l]);
    }
  }
  resident.update(largest, model.morph.viewpoint);
  for (const CellId family : resident.went()) placed.runs.forget(*placed.open.hierarchy, family);
  for (const CellId family : resident.went())
    if (std::erase(placed.came, family) == 0) placed.went.push_back(family);
  placed.came.insert(placed.came.end(), resident.came().begin(), resident.came().end());
  if (std::exchange(placed.revision, resident.revision()) == resident.revision()) return false;
  const DetailLimits limits = resident.limits();
  const bool same = resident.came().empty() && resident.went().empty() && std::ranges::equal(placed.limits, limits);
  placed.limits.assign(limits.begin(), limits.end());
  return !same;
}

// Signatures that the file has not are found when they are first asked for; placements of one model share them. Of a
// streamed one they cannot be found: it gets radii per level, which keep the tolerance, too.
void SceneView::set_radii(Placed& placed, const RadiiConfig& config) {
  if (placed.radii_config == config) return;
  const Hierarchy& hierarchy = *placed.open.hierarchy;
  RadiiConfig possible = config;
  if (placed.open.resident && !hierarchy.signatures && config.rule == RadiiRule::adaptive)
    possible.rule = RadiiRule::per_level;
  if (possible.rule == RadiiRule::adaptive && !placed.signatures) {
    const auto same = std::ranges::find_if(
        placed_, [&](const Placed& p) { return p.open.hierarchy == &hierarchy && p.signatures != nullptr; });
    placed.signatures = same == placed_.end() ? signatures_of(hierarchy) : same->signatures;
  }
  placed.radii = make_radii(hierarchy, possible, placed.signatures);
  placed.radii_config = config;
}

bool SceneView::update(const Camera& camera, const ViewConfig& config, std::span<const ViewConfig> beside) {
  const bool rests = camera_ && *camera_ == camera && config_ == config;
  const auto streamed_one = [](const Placed& p) { return p.open.resident != nullptr; };
  if (rests && (frozen_ || std::ranges::none_of(placed_, streamed_one))) return false;
  std::vector<PlacedBounds> bounds;
  for (const Placed& placed : placed_)
    bounds.push_back({placed.in_picture, placed.open.hierarchy->cells.front().bounds});
  const View view(in_space(camera, origin_, unit_), bounds, config.size);  // may throw: nothing has changed yet
  camera_.reset();
  config_ = config;
  if (!rests && !frozen_)
    for (Placed& placed : placed_) set_radii(placed, for_picture(config.radii, config.size, camera.vertical_fov));

  bool streamed = false;
  for (std::size_t m = 0; m < placed_.size(); ++m) {
    Placed& placed = placed_[m];
    ModelFrame& model = frame_.models[m];
    model.model = placed.uploaded;
    model.view_projection = view.projection(placed.in_picture);
    model.towards_eye = view.towards_eye(placed.in_picture);
    model.towards_light =
        to_float(placed.placement.rotated_back((1 / length(config.towards_light)) * config.towards_light));
    model.appearance = placed.appearance;
    model.clip.reset();
    if (config.clip) model.clip = in_model_space(*config.clip, placed.placement);
    model.morph.blend = config.blend;
    if (frozen_) continue;
    model.morph = {placed.open.hierarchy, &placed.radii, config.blend, view.viewpoint(placed.in_picture)};
    if (placed.open.resident && !is_hidden(m)) streamed = stream(placed, model, camera, beside) || streamed;
    model.morph.limits = placed.limits;
  }
  camera_ = camera;
  if (rests && !streamed) return false;
  frame_.settings = complete_settings(config.settings, config.effects, bounding_sphere().radius);
  // In double: the unit may be beyond the range of float, and a density of 0 is 0 then, too.
  constexpr double longest_radius = std::numeric_limits<float>::max();
  float &density = frame_.settings.fog.density, &radius = frame_.settings.ambient_occlusion.radius;
  density = static_cast<float>(double{density} * unit_);
  radius = static_cast<float>(std::min(double{radius} / unit_, longest_radius));
  frame_.lens = view.lens();
  frame_.size = config.size;
  frame_.samples = config.samples;
  frame_.cull_occluded = config.cull_occluded;
  frame_.select_on_device =
      config.select_on_device && !frozen_ && std::ranges::find(config.hidden, true) == config.hidden.end();
  for (std::size_t m = 0; m < placed_.size(); ++m) {
    if (!frozen_) select(frame_.models[m], placed_[m], is_hidden(m));
    frame_.models[m].selection = is_hidden(m) ? &no_cells : &placed_[m].selection;
    frame_.models[m].runs = &placed_[m].runs;
    frame_.models[m].casters = nullptr;
    const bool closed = config.clip && m < config.closed.size() && config.closed[m];
    frame_.models[m].solid = closed ? frame_.models[m].selection : nullptr;
  }
  if (frame_.settings.lighting.directional.shadows) see_from_light();
  plan_effects(frame_, config.effects);
  return changed_ = true;
}

void SceneView::select(const ModelFrame& model, Placed& placed, bool hidden) {
  if (hidden) {
    placed.selection = {};  // streamed cells of it may go
    return;
  }
  const Frustum frustum = frustum_of(model.view_projection);
  SelectionConfig config{&frustum, false, model.morph.limits, nullptr};
  const bool backs_count = frame_.settings.overdraw || config_.clip || camera_->vertical_fov > widest_culled;
  if (placed.open.back_faces && !backs_count)
    config.cones = placed.open.back_faces->cones_from(model.morph.viewpoint, placed.appearance);
  select_cells(*placed.open.hierarchy, placed.radii, model.morph.viewpoint, config, placed.selection);
  placed.runs.cull(*placed.open.hierarchy, model.view_projection, frame_.size, placed.selection, placed.ranges);
}

// The shadow map covers the visible cells and the cells that may throw a shadow on them. Casters are the same morphed
// surface as the picture's, selected for the camera, and culled by the light with its runs.
void SceneView::see_from_light() {
  std::vector<Vec3d> receivers, casters;
  std::vector<ModelPlacement> placements;
  for (const Placed& placed : placed_) {
    const Similarity& s = placed.in_picture;
    ModelPlacement& to = placements.emplace_back();
    for (std::size_t row = 0; row < 3; ++row) {
      const Vec3d r = s.scale * s.rotation[row];
      to[4 * row] = r.x, to[4 * row + 1] = r.y, to[4 * row + 2] = r.z;
    }
    to[3] = s.translation.x, to[7] = s.translation.y, to[11] = s.translation.z;
    const Hierarchy& hierarchy = *placed.open.hierarchy;
    const auto add = [&](std::vector<Vec3d>& points, CellId cell, int level) {
      const float margin = hierarchy.displacement_bound(level);  // morphed vertices leave the bounds
      Box3f box = hierarchy.cells[cell].bounds;
      box.lo = box.lo - Vec3f{margin, margin, margin}, box.hi = box.hi + Vec3f{margin, margin, margin};
      const std::array<Vec3d, 8> corners = corners_of(box, to);
      points.insert(points.end(), corners.begin(), corners.end());
    };
    if (is_hidden(placements.size() - 1)) continue;
    add(casters, CellId(0), 0);
    for (const SelectedCell& cell : placed.selection.cells)
      if (cell.visible) add(receivers, cell.cell, cell.level);
  }
  if (casters.empty()) return;  // all are hidden
  const int texels = frame_.settings.lighting.directional.shadow_texels;
  const LightView light = fit_light(config_.towards_light, receivers, casters, texels);
  for (std::size_t m = 0; m < placed_.size(); ++m) {
    Placed& placed = placed_[m];
    ModelFrame& model = frame_.models[m];
    if (is_hidden(m)) continue;
    model.light_projection = light_projection(light, placements[m]);
    const Frustum frustum = frustum_of(model.light_projection);
    select_cells(*placed.open.hierarchy, placed.radii, model.morph.viewpoint, {&frustum, false, model.morph.limits},
                 placed.casters);
    placed.runs.cull(*placed.open.hierarchy, model.light_projection, {texels, texels}, placed.casters,
                     placed.caster_ranges);
    model.casters = &placed.casters;
  }
}

bool SceneView::complete() const {
  return std::ranges::all_of(placed_, [](const Placed& p) { return !p.open.resident || p.open.resident->complete(); });
}

std::uint64_t SceneView::resident_bytes() const {
  std::uint64_t bytes = 0;
  for (const Placed& placed : placed_) bytes += placed.open.resident ? placed.open.resident->bytes() : 0;
  return bytes;
}

float SceneView::limit_rate(std::size_t model) const {
  const ResidentCells* resident = placed_[model].open.resident;
  return resident ? resident->rate() : 0;
}

bool SceneView::admissible() const {
  return std::ranges::all_of(placed_, [](const Placed& p) { return p.radii.admissible; });
}

FrameStats SceneView::draw(Renderer& renderer, const Frame& frame) {
  if (!changed_) return {};
  for (Placed& placed : placed_) {
    if (!placed.went.empty() || !placed.came.empty()) renderer.refresh(placed.uploaded, placed.went, placed.came);
    placed.went.clear(), placed.came.clear();
  }
  changed_ = false;
  return renderer.draw(frame);
}

std::vector<Camera> camera_path(const SceneView& view, ImageSize size) {
  const SceneCamera& way = view.scene().camera;
  const Framing framing{view.up(), aspect_of(size)};
  if (way.path.empty()) return resample_path(way.keys, way.frames, "the camera's keys");
  if (way.path == "orbit") return orbit_path(view.bounding_sphere(), way.frames, framing);
  if (way.path == "wander") return wander_path(view.bounding_sphere(), way.frames, framing.up);
  if (!is_model_path(way.path)) return read_camera_path(way.path, way.frames, framing.up);
  std::size_t to = 0;
  while (!way.fly_to.empty() && view.scene().models[to].name != way.fly_to) ++to;
  // The model's own path, moved to its placement.
  const Similarity own = to_similarity(view.hierarchy(to).transform);
  const Vec3d up = view.placement(to).rotated_back(framing.up);
  std::vector<Camera> path = model_path(way.path, view.hierarchy(to), way.frames, Framing{up, framing.aspect});
  for (Camera& camera : path) {
    camera.up = framing.up;
    camera.position = view.placement(to)(own.inverse(camera.position));
    camera.target = view.placement(to)(own.inverse(camera.target));
  }
  return path;
}

}  // namespace lodestone
