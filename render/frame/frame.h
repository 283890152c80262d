// A frame as plain data: all that a picture depends on.
#pragma once

#include <optional>
#include <vector>

#include "core/math/vec3.h"
#include "core/mesh/attributes.h"
#include "render/camera/projection.h"
#include "render/frame/effect.h"
#include "render/lod/morph.h"
#include "render/lod/selection.h"

namespace lodestone {

class CullingRuns;  // render/culling/runs.h

// How a placed model looks; its own materials, textures and colours are in its hierarchy. Colours as the picture has
// them, each channel in [0, 1], without a transfer curve.
struct Appearance {
  Vec3f base_colour{0.8f, 0.78f, 0.74f};  // times vertex colour, material and texture
  float opacity = 1;                      // in [0, 1]
  bool smooth = true;                     // normals interpolated over a triangle; false: one for each triangle
  // Those that the model has are shown. `textures` are its materials, alpha and sides included.
  bool vertex_colours = true, textures = true, normal_maps = true;
  friend bool operator==(const Appearance&, const Appearance&) = default;
};

// Light from very far away, from one direction.
struct DirectionalLight {
  float strength = 0;        // at least 0; 0: none
  bool shadows = false;      // surfaces nearer to the light cast a shadow
  int shadow_texels = 2048;  // a side of the shadow map, from 16 to 8192
  friend bool operator==(const DirectionalLight&, const DirectionalLight&) = default;
};

// colour = albedo (ambient + (1 - ambient) min(1, sum of lights)), a light giving strength times cosine.
struct Lighting {
  float ambient = 0.2f;  // in [0, 1]; 1: unlit
  float head = 1;        // strength of the light at the eye, at least 0
  DirectionalLight directional;
  friend bool operator==(const Lighting&, const Lighting&) = default;
};

// A density or radius of this value follows from the size of the scene (complete_settings in render/effects/plan.h). A
// frame to be drawn has none of these.
inline constexpr float by_scene_size = -1;

// A point at a distance d from the eye keeps a share exp(-density d) of its colour.
struct Fog {
  Vec3f colour{0.7f, 0.75f, 0.8f};
  float density = 0;  // per unit of clip w, at least 0, or by_scene_size; 0: none
  friend bool operator==(const Fog&, const Fog&) = default;
};

// Darkening of creases, from the depth of the picture.
struct AmbientOcclusion {
  float strength = 0;  // in [0, 1]; 0: none
  float radius = 0;    // units of clip w, or by_scene_size
  friend bool operator==(const AmbientOcclusion&, const AmbientOcclusion&) = default;
};

// Parameters of the effects that concern all models of a frame.
struct FrameSettings {
  Lighting lighting;
  Fog fog;
  AmbientOcclusion ambient_occlusion;
  float level_tint = 0;                                     // share of the colour that tells the level, in [0, 1]
  float wireframe = 0;                                      // opacity of the edges of triangles, in [0, 1]
  Vec3f background{24.0f / 255, 26.0f / 255, 30.0f / 255};  // where no model is
  bool overdraw = false;  // instead of the picture: how many triangles lie over each other in a pixel
  friend bool operator==(const FrameSettings&, const FrameSettings&) = default;
};

// One model, where it is placed. Directions are unit vectors in the model's normalised space.
struct ModelFrame {
  std::uint32_t model = 0;  // of those uploaded
  MorphContext morph;
  const Selection* selection = nullptr;  // a backend draws its visible cells
  CullingRuns* runs = nullptr;     // for selection on the device, and Frame::cull_occluded; null: whole cells alone
  ViewProjection view_projection;  // of normalised model space
  Vec3f towards_eye{0, 0, 1};      // where the head light comes from
  Vec3f towards_light{0, 0, 1};    // where the directional light comes from
  Appearance appearance;
  std::optional<Plane> clip;  // in normalised space; what lies behind it is not drawn and throws no shadow
  // All visible cells of a surface that bounds a solid, whose cut by the clipping plane is filled; null: left open.
  const Selection* solid = nullptr;
  std::optional<Vec3f> tint;  // of the effect level_tint, instead of a hue for each level
  EffectSet effects{Effect::geomorph, Effect::smooth_normals, Effect::head_light};
  // For the shadow map, if the directional light casts shadows: the projection into the light's clip space, and the
  // cells that can throw a shadow into the picture, in view or not.
  ViewProjection light_projection;
  const Selection* casters = nullptr;
};

struct Frame {
  std::vector<ModelFrame> models = std::vector<ModelFrame>(1);
  FrameSettings settings;
  EffectSet effects;  // passes over the whole picture: shadow, ambient occlusion, transparency, overdraw
  Lens lens;          // for effects that need distances
  ImageSize size;
  // Cells that others hide, and runs of their triangles, are left out: changes no picture, and pays where much is
  // hidden. Ignored where an effect shows what is behind something.
  bool cull_occluded = false;
  // Backends that select cells on their device do so, instead of taking ModelFrame::selection: the same cells.
  bool select_on_device = false;
  int samples = 1;  // a pixel: 1, or 4 averaged (multisampling: coverage and depth a sample, colour once a triangle)

  // The only model of a frame that has one.
  [[nodiscard]] ModelFrame& only() { return models.front(); }
  [[nodiscard]] const ModelFrame& only() const { return models.front(); }
  // cull_occluded holds: neither transparency nor overdraw, which show what is behind.
  [[nodiscard]] bool culls_occluded() const {
    return cull_occluded && !all_effects().contains_any({Effect::transparency, Effect::overdraw});
  }
  // The effects of any model, or of the whole picture.
  [[nodiscard]] EffectSet all_effects() const {
    EffectSet set = effects;
    for (const ModelFrame& m : models) set = set | m.effects;
    return set;
  }
};

}  // namespace lodestone
