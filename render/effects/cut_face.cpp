#include "render/effects/cut_face.h"

#include <algorithm>
#include <cmath>

#include "render/effects/transparency.h"
#include "render/frame/shading.h"

namespace lodestone::effects {
namespace {

bool is_filled(const Frame& frame, const ModelFrame& model) {
  if (!model.clip || !model.solid || is_transparent(frame, model) || shows_alpha(frame, model)) return false;
  const Eye eye = eye_of(model.view_projection);
  return dot(model.clip->n, eye.at) + model.clip->d * eye.w < 0;
}

Vec3f lit(const Frame& frame, const ModelFrame& model) {
  const Lighting& lighting = frame.settings.lighting;
  const Vec3f towards_kept = (1 / length(model.clip->n)) * model.clip->n;
  float light = 0;
  if (model.effects.contains(Effect::head_light))
    light += lighting.head * std::abs(dot(towards_kept, model.towards_eye));
  if (model.effects.contains(Effect::directional_light))
    light += lighting.directional.strength * std::max(-dot(towards_kept, model.towards_light), 0.0f);
  return (lighting.ambient + (1 - lighting.ambient) * std::min(light, 1.0f)) * shading::cut_albedo;
}

}  // namespace

std::vector<CutFace> cut_faces(const Frame& frame) {
  std::vector<CutFace> faces;
  for (const ModelFrame& model : frame.models) {
    if (!is_filled(frame, model)) continue;
    if (const auto depth = depth_of_plane(model.view_projection, *model.clip, frame.size))
      faces.push_back({&model, *depth, lit(frame, model)});
  }
  return faces;
}

Vec3f cut_colour(const CutFace& face, const Frame& frame, double x, double y, double z) {
  const Fog& fog = frame.settings.fog;
  if (!face.model->effects.contains(Effect::fog) || !(fog.density > 0)) return face.colour;
  const Lens& lens = frame.lens;
  const double w = double{lens.near} * lens.far / (lens.far - z * (double{lens.far} - lens.near)),
               right = (2 * x / frame.size.width - 1) * lens.tan_x, up = (2 * y / frame.size.height - 1) * lens.tan_y;
  const auto share = static_cast<float>(std::exp(-fog.density * w * std::sqrt(1 + right * right + up * up)));
  return share * face.colour + (1 - share) * fog.colour;
}

}  // namespace lodestone::effects
