#include "experiments/systems/system_pictures.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/base/error.h"

namespace lodestone {
namespace {

// The radii that make the usual selection and morph draw what the system draws. `level`: of cross_fade and full.
Radii radii_of(LodSystem system, const Radii& radii, int level) {
  switch (system) {
    case LodSystem::morph:
    case LodSystem::step:
      return radii;
    case LodSystem::discrete:
      return without_morph(radii);
    case LodSystem::cross_fade:
    case LodSystem::full:
      break;
  }
  return whole_level(radii, level);
}

void add_up(const FrameStats& from, FrameStats& to) {
  to.cells += from.cells;
  to.triangles += from.triangles;
  to.draw_calls += from.draw_calls;
  for (const auto& [stage, milliseconds] : from.milliseconds) to.milliseconds[stage] += milliseconds;
  for (const auto& [what, count] : from.work) to.work[what] += count;
  to.warnings.insert(to.warnings.end(), from.warnings.begin(), from.warnings.end());
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

SystemPictures::SystemPictures(SceneView& scene, Renderer& renderer, const SystemConfig& config)
    : scene_(scene), renderer_(renderer), config_(config) {
  for (std::size_t m = 0; m < scene.model_count(); ++m)
    if (scene.limit_rate(m) > 0)
      throw InputError("LOD systems are compared on whole models; open the scene without a memory budget");
}

// Draws the frame of the view with these radii, one for each model, and puts it into the picture.
void SystemPictures::draw_part(const std::vector<Radii>& radii, SystemPicture& picture) {
  Frame frame = scene_.frame();
  frame.select_on_device = false;
  std::vector<Selection> drawn(radii.size()), casters(radii.size());
  for (std::size_t m = 0; m < radii.size(); ++m) {
    ModelFrame& model = frame.models[m];
    const auto select = [&](const ViewProjection& projection, Selection& out) {
      const Frustum frustum = frustum_of(projection);
      select_cells(*model.morph.hierarchy, radii[m], model.morph.viewpoint, {&frustum, false}, out);
    };
    model.morph.radii = &radii[m];
    select(model.view_projection, drawn[m]);
    model.selection = &drawn[m];
    if (!model.casters) continue;
    select(model.light_projection, casters[m]);
    model.casters = &casters[m];
  }
  add_up(renderer_.draw(frame), picture.stats);
}

SystemPicture SystemPictures::draw(LodSystem system, const Camera& camera, const ViewConfig& view) {
  if (system == LodSystem::cross_fade && scene_.model_count() > 1)
    throw InputError("the system cross-fade is made for one model; this scene has several");
  ViewConfig config = view;
  if (system == LodSystem::step) config.blend = Blend::step;
  (void)scene_.update(camera, config);

  SystemPicture picture;
  std::vector<Radii> fine, coarse;
  for (std::size_t m = 0; m < scene_.model_count(); ++m) {
    const ModelFrame& seen = scene_.frame().models[m];
    SystemModel& model = picture.models.emplace_back();
    model.hierarchy = seen.morph.hierarchy;
    model.blend = seen.morph.blend;
    model.viewpoint = seen.morph.viewpoint;
    model.view_projection = seen.view_projection;
    if (system == LodSystem::cross_fade)
      model.fade = cross_fade(*model.hierarchy, *seen.morph.radii, model.viewpoint, config_.fade_width);
    const int level = system == LodSystem::full ? model.hierarchy->finest() : model.fade.fine;
    model.morph = *seen.morph.radii;
    model.radii = radii_of(system, *seen.morph.radii, level);
    select_cells(*model.hierarchy, model.radii, model.viewpoint, {}, model.whole);
    fine.push_back(model.radii);
    coarse.push_back(radii_of(system, *seen.morph.radii, model.fade.coarse));
  }
  draw_part(fine, picture);
  picture.image = renderer_.read_back();
  const CrossFade& fade = picture.models.front().fade;
  if (fade.fine != fade.coarse) {
    draw_part(coarse, picture);
    picture.image = blended(picture.image, renderer_.read_back(), fade.share);
    picture.pictures = 2;
  }
  return picture;
}

}  // namespace lodestone
