#include "render/scene/scene_view.h"

#include <algorithm>
#include <cassert>

#include "core/base/error.h"
#include "render/look.h"

namespace lodestone {
namespace {

// A model without colours of its own that are shown is plain; where it has some, they are shown as they are.
Look look_of(const SceneModel& model, const Hierarchy& hierarchy) {
  Look look = model.look;
  const bool coloured =
      (look.vertex_colours && hierarchy.attributes.colours) || (look.textures && has_surface_colours(hierarchy));
  if (coloured) look.base_colour = {1, 1, 1};
  if (model.colour) look.base_colour = *model.colour;
  return look;
}

bool same_limits(const std::vector<DetailLimit>& a, DetailLimits b) {
  return std::ranges::equal(a, b, [](const DetailLimit& p, const DetailLimit& q) {
    return p.box.lo == q.box.lo && p.box.hi == q.box.hi && p.radius == q.radius;
  });
}

}  // namespace

ViewConfig view_config(const Scene& scene, ImageSize size) {
  return {size, 1, scene.radii, scene.blend, scene.setting, scene.effects};
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
    placed.look = look_of(scene.models[m], hierarchy);
    // One that stands in several places is uploaded once.
    const auto same = std::ranges::find(placed_, models[m].hierarchy, [](const Placed& p) { return p.open.hierarchy; });
    placed.uploaded = same == placed_.end() ? uploaded++ : same->uploaded;
    placed_.push_back(std::move(placed));
  }
  place_models();
  frame_.models.resize(placed_.size());
}

// In units in which single precision is good for what lies before the camera. A model alone is drawn in its normalised
// space: the numbers are those of its hierarchy, wherever it stands.
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

void SceneView::upload(Renderer& renderer) const {
  std::vector<const Hierarchy*> models;
  for (const Placed& placed : placed_)
    if (placed.uploaded == models.size()) models.push_back(placed.open.hierarchy);
  renderer.upload(models);
}

RadiiConfig SceneView::radii_config(const Camera& camera) const {
  RadiiConfig radii = config_.radii;
  radii.image_height = config_.size.height;
  radii.aspect = static_cast<float>(config_.size.width) / static_cast<float>(config_.size.height);
  radii.vertical_fov = static_cast<float>(camera.vertical_fov);
  return radii;
}

bool SceneView::look(const Camera& camera, const ViewConfig& config) {
  const bool rests = camera_ && *camera_ == camera && config_ == config;
  if (rests && std::ranges::none_of(placed_, [](const Placed& p) { return p.open.resident != nullptr; })) return false;
  std::vector<PlacedBounds> bounds;
  for (const Placed& placed : placed_)
    bounds.push_back({placed.in_picture, placed.open.hierarchy->cells.front().bounds});
  const View view(in_space(camera, origin_, unit_), bounds, config.size);  // may throw: nothing has changed yet
  camera_.reset();
  config_ = config;
  if (!rests)
    for (Placed& placed : placed_) placed.radii = make_radii(*placed.open.hierarchy, radii_config(camera));

  bool streamed = false;
  for (std::size_t m = 0; m < placed_.size(); ++m) {
    Placed& placed = placed_[m];
    ModelFrame& model = frame_.models[m];
    model.model = placed.uploaded;
    model.morph = {placed.open.hierarchy, &placed.radii, config.blend, view.viewpoint(placed.in_picture)};
    model.view_projection = view.projection(placed.in_picture);
    model.towards_eye = view.towards_eye(placed.in_picture);
    model.towards_light =
        to_float(placed.placement.rotated_back((1 / length(scene_.towards_light)) * scene_.towards_light));
    model.look = placed.look;
    if (placed.open.resident) {
      ResidentCells& resident = *placed.open.resident;
      const std::vector<DetailLimit> before(resident.limits().begin(), resident.limits().end());
      const Frustum frustum = frustum_of(model.view_projection);
      resident.update(placed.radii, model.morph.viewpoint, &frustum);
      model.morph.limits = resident.limits();
      streamed =
          streamed || !resident.came().empty() || !resident.went().empty() || !same_limits(before, resident.limits());
    }
  }
  camera_ = camera;
  if (rests && !streamed) return false;
  frame_.setting = config.setting;
  frame_.setting.fog.density *= static_cast<float>(unit_);
  frame_.setting.ambient_occlusion.radius /= static_cast<float>(unit_);
  frame_.lens = view.lens();
  frame_.size = config.size;
  frame_.samples = config.samples;
  for (std::size_t m = 0; m < placed_.size(); ++m) select(view, frame_.models[m], placed_[m]);
  plan_effects(frame_, config.effects);
  return changed_ = true;
}

void SceneView::select(const View&, ModelFrame& model, Placed& placed) {
  const Frustum frustum = frustum_of(model.view_projection);
  select_cells(*placed.open.hierarchy, placed.radii, model.morph.viewpoint, {&frustum, false, model.morph.limits},
               placed.selection);
  model.selection = &placed.selection;
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

FrameStats SceneView::draw(Renderer& renderer) {
  if (!changed_) return {};
  for (const Placed& placed : placed_)
    if (const ResidentCells* resident = placed.open.resident)
      renderer.refresh(placed.uploaded, resident->went(), resident->came());
  changed_ = false;
  return renderer.draw(frame_);
}

std::vector<Camera> camera_path(const SceneView& view) {
  const SceneCamera& way = view.scene().camera;
  if (way.path.empty()) return resample_path(way.keys, way.frames, "the camera's keys");
  if (way.path == "orbit") return orbit_path(view.bounding_sphere(), way.frames);
  if (way.path != "fly-in") return read_camera_path(way.path, way.frames);
  std::size_t to = 0;
  while (!way.fly_to.empty() && view.scene().models[to].name != way.fly_to) ++to;
  // Its own path, taken along to where it stands.
  const Similarity own = to_similarity(view.hierarchy(to).transform);
  std::vector<Camera> path = fly_in_path(view.hierarchy(to), way.frames);
  for (Camera& camera : path) {
    camera.position = view.placement(to)(own.inverse(camera.position));
    camera.target = view.placement(to)(own.inverse(camera.target));
  }
  return path;
}

}  // namespace lodestone
