#include "render/frame/renderer.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace lodestone {

namespace {

void check_share(const char* what, float value) {
  if (!(value >= 0 && value <= 1))
    throw InputError(describe("", "the frame", std::string("the ") + what + " must lie between 0 and 1"));
}

void check_not_negative(const char* what, float value) {
  if (!(value >= 0 && std::isfinite(value)))
    throw InputError(describe("", "the frame", std::string("the ") + what + " must be at least 0 and finite"));
}

}  // namespace

void check_frame(const Frame& frame, int largest_side) {
  const auto [width, height] = frame.size;
  if (width < 1 || height < 1 || width > largest_side || height > largest_side)
    throw InputError("a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                     " pixels is out of range; this backend draws 1 to " + std::to_string(largest_side) + " a side");
  if (frame.samples != 1 && frame.samples != 4)
    throw InputError("a pixel has 1 or 4 samples, not " + std::to_string(frame.samples));
  for (const ModelFrame& model : frame.models) {
    const auto finite = [](const ViewProjection& vp) {
      return std::ranges::all_of(vp.m, [](float v) { return std::isfinite(v); });
    };
    if (!finite(model.view_projection) || !finite(model.light_projection) || !is_finite(model.morph.viewpoint) ||
        !is_finite(model.towards_eye) || !is_finite(model.towards_light))
      throw InputError(describe("", "the frame", "matrices, viewpoints and lights must be finite numbers"));
    if (model.clip && !(is_finite(model.clip->n) && std::isfinite(model.clip->d)))
      throw InputError(describe("", "the frame", "a clipping plane must have finite numbers"));
    check_share("opacity", model.appearance.opacity);
  }
  const FrameSettings& settings = frame.settings;
  check_share("ambient light", settings.lighting.ambient);
  check_share("level tint", settings.level_tint);
  check_share("wireframe opacity", settings.wireframe);
  check_share("strength of ambient occlusion", settings.ambient_occlusion.strength);
  check_not_negative("radius of ambient occlusion", settings.ambient_occlusion.radius);
  check_not_negative("strength of the head light", settings.lighting.head);
  check_not_negative("strength of the directional light", settings.lighting.directional.strength);
  if (const int texels = settings.lighting.directional.shadow_texels; texels < 16 || texels > 8192)
    throw InputError(describe("", "the frame", "a shadow map has 16 to 8192 texels a side"));
  check_not_negative("density of the fog", settings.fog.density);
}

}  // namespace lodestone
