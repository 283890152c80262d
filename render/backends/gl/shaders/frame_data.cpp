// The parts of a frame that are sent to the device, and the variants of the programs that draw it.
#include <bit>

#include "render/backends/gl/shaders/draw_program.h"
#include "render/camera/projection.h"
#include "render/effects/effect_info.h"
#include "render/effects/shadow.h"
#include "render/effects/transparency.h"
#include "render/frame/shading.h"
#include "render/textures/surface_textures.h"

namespace lodestone {

namespace {

std::uint32_t material_bits_of(const Frame& frame, const ModelFrame& model, GlPass pass) {
  const bool blended = shows_alpha(frame, model, AlphaMode::blend), masked = shows_alpha(frame, model, AlphaMode::mask);
  const bool all_layers = effects::is_transparent(frame, model),
             from_light = pass == GlPass::shadow || pass == GlPass::shadow_layers,
             opaque_pass = pass == GlPass::picture || pass == GlPass::shadow;
  std::uint32_t bits = effects::has_one_side(model) && !from_light ? leaves_out_backs : 0;
  if (blended && !all_layers) bits |= opaque_pass ? leaves_out_blended : leaves_out_others;
  const bool alpha = opaque_pass ? masked : blended || (masked && all_layers);
  if (alpha) bits |= reads_alpha;
  if (alpha && model.appearance.vertex_colours && model.morph.hierarchy->attributes.colours) bits |= reads_vertex_alpha;
  return bits;
}

}  // namespace

GlVariant variant_of(const Frame& frame, const ModelFrame& model, GlPass pass) {
  GlVariant variant;
  variant.blend = model.morph.blend, variant.metric = model.morph.radii->metric;
  variant.pass = pass;
  variant.given = !model.morph.radii->by_cell.empty();
  variant.limited = !variant.given && !model.morph.limits.empty();
  variant.clipped = model.clip.has_value();
  const bool counts = pass == GlPass::count || pass == GlPass::winding;
  if (pass == GlPass::shadow || pass == GlPass::shadow_layers || counts) {
    variant.effects = model.effects & EffectSet{Effect::geomorph};
    if (!counts) variant.material_bits = material_bits_of(frame, model, pass);
    return variant;
  }
  // Effects without code in the programs need no programs of their own, and neither do those that find nothing to show:
  // compilers round the same formula differently beside other code, and a picture must not depend on what it does not
  // show.
  EffectSet shown{Effect::geomorph};
  for (const EffectInfo& info : effect_infos()) {
    const bool coded = !info.of_picture && !(info.glsl.vertex.empty() && info.glsl.fragment.empty());
    if (coded && !info.called_for(frame, model).empty()) shown.insert(info.effect);
  }
  variant.effects = model.effects & shown;
  const EffectSet lights{Effect::head_light, Effect::directional_light};
  const bool smooth = model.appearance.smooth && variant.effects.contains(Effect::smooth_normals);
  variant.face_normals = variant.effects.contains_any(lights) && !smooth;
  variant.effects.set(Effect::vertex_colours, variant.effects.contains(Effect::vertex_colours) &&
                                                  model.appearance.vertex_colours &&
                                                  model.morph.hierarchy->attributes.colours);
  variant.effects.set(Effect::texture, shows_textures(model));
  variant.effects.set(Effect::normal_map, shows_normal_maps(model));
  variant.effects.set(Effect::occlusion_map, shows_occlusion_maps(model));
  variant.effects.set(Effect::unlit, shows_unlit(model));
  variant.effects.set(Effect::emission, shows_emission(model));
  variant.effects.set(Effect::shadow,
                      variant.effects.contains(Effect::directional_light) && effects::has_shadow_pass(frame));
  variant.material_bits = material_bits_of(frame, model, pass);
  return variant;
}

GlInstance instance_of(const ModelFrame& model, std::uint32_t first_material) {
  GlInstance to;
  for (std::size_t i = 0; i < 16; ++i) {
    to.clip_rows[i / 4][i % 4] = model.view_projection.m[i];
    to.light_rows[i / 4][i % 4] = model.light_projection.m[i];
  }
  const auto set = [](float* out, Vec3f v) {
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
  };
  set(to.viewpoint, model.morph.viewpoint);
  set(to.towards_eye, model.towards_eye);
  set(to.towards_light, model.towards_light);
  if (model.clip) {
    to.viewpoint[3] = model.clip->n.x;
    to.towards_eye[3] = model.clip->n.y;
    to.towards_light[3] = model.clip->n.z;
    to.flags[3] = std::bit_cast<std::uint32_t>(model.clip->d);
  }
  const Eye eye = eye_of(model.view_projection);
  set(to.eye, eye.at);
  to.eye[3] = eye.w;
  set(to.base_colour, model.appearance.base_colour);
  to.base_colour[3] = model.appearance.opacity;
  to.flags[0] = (model.appearance.smooth ? smooth_flag : 0) | (model.appearance.vertex_colours ? colours_flag : 0) |
                (model.appearance.textures ? textures_flag : 0) | (model.appearance.normal_maps ? normal_maps_flag : 0);
  const Hierarchy& hierarchy = *model.morph.hierarchy;
  to.flags[0] |=
      (hierarchy.attributes.uv ? has_uv_flag : 0) | (hierarchy.attributes.materials ? has_materials_flag : 0);
  to.flags[1] = first_material;
  to.flags[2] = hierarchy.materials.empty() ? 0 : 1;
  const Radii& radii = *model.morph.radii;
  for (std::size_t l = 0; l < radii.band_begin.size(); ++l) {
    to.levels[l].band_begin = radii.band_begin[l];
    to.levels[l].band_end = radii.band_end[l];
    set(to.levels[l].tint, model.tint.value_or(shading::tint_of(static_cast<int>(l))));
  }
  return to;
}

GlFrameUniforms uniforms_of(const Frame& frame) {
  const FrameSettings& settings = frame.settings;
  const Lighting& lighting = settings.lighting;
  const Fog& fog = settings.fog;
  const Lens& lens = frame.lens;
  return {{fog.colour.x, fog.colour.y, fog.colour.z, fog.density},
          {lens.tan_x, lens.tan_y, lens.near, lens.far},
          {static_cast<float>(frame.size.width), static_cast<float>(frame.size.height)},
          lighting.ambient,
          lighting.head,
          lighting.directional.strength,
          lighting.directional.shadows ? 1.0f : 0.0f,
          settings.level_tint,
          settings.wireframe};
}

}  // namespace lodestone
