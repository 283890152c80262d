#include "render/textures/surface_textures.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/formats/gltf/gltf_surface.h"
#include "core/mesh/uv_map.h"
#include "core/texture/colour.h"
#include "core/texture/image_codec.h"
#include "core/texture/normal_space.h"
#include "render/frame/appearance.h"

namespace lodestone {
namespace {

PixelSize halved(PixelSize size, std::uint32_t times) {
  for (; times > 0; --times) size = half_of(size);
  return size;
}

std::uint64_t texels_of(PixelSize size) { return std::uint64_t{size.width} * size.height; }

// The encoded image nearest to the shown size, and the factor by which it is to be reduced further.
struct Encoded {
  std::span<const char> bytes;
  std::uint32_t halvings = 0;
};
Encoded nearest_copy(const Hierarchy& hierarchy, std::uint32_t texture, std::uint32_t halvings) {
  Encoded best{hierarchy.textures[texture].bytes, halvings};
  for (const TextureCopy& copy : hierarchy.texture_copies)
    if (copy.texture == texture && copy.halvings <= halvings) best = {copy.bytes, halvings - copy.halvings};
  return best;
}

}  // namespace

void SurfaceTextures::set_models(std::span<const Hierarchy* const> models, const TextureLimits& limits) {
  *this = {};
  models_.assign(models.begin(), models.end());
  for (const Hierarchy* model : models_) add_model(*model);
  reduce(limits);
}

void SurfaceTextures::add_model(const Hierarchy& hierarchy) {
  // A model used several times shows the same textures.
  const auto known = std::ranges::find(models_, &hierarchy);
  if (const auto index = static_cast<std::size_t>(known - models_.begin()); index < materials_.size()) {
    materials_.push_back(materials_[index]);
    return;
  }
  std::vector<SurfaceMaterial>& made = materials_.emplace_back(1);
  for (const Material& m : hierarchy.materials) made.push_back(surface_of(hierarchy, m));
}

SurfaceMaterial SurfaceTextures::surface_of(const Hierarchy& hierarchy, const Material& m) {
  const auto encoded = [](double linear) { return static_cast<float>(linear_to_srgb(linear)); };
  SurfaceMaterial to;
  to.base_colour = {encoded(m.base_colour[0]), encoded(m.base_colour[1]), encoded(m.base_colour[2])};
  const double strength = emissive_strength(m);
  if (!m.unlit)
    to.emission = {encoded(strength * m.emissive[0]), encoded(strength * m.emissive[1]),
                   encoded(strength * m.emissive[2])};
  to.normal_scale = m.normal_scale;
  to.occlusion_strength = m.occlusion_strength;
  to.alpha_mode = m.alpha_mode;
  to.alpha = m.base_colour[3];
  to.alpha_cutoff = m.alpha_cutoff;
  to.one_sided = !m.double_sided;
  to.unlit = m.unlit;
  if (!hierarchy.attributes.uv) return to;
  const auto place = [&](const UvTransform& transform) {
    moves_maps_ = moves_maps_ || transform != UvTransform{};
    const UvMap map = map_of(transform);
    const auto n = [&](std::size_t k) { return static_cast<float>(map[k]); };
    return MapPlace{n(0), n(1), n(2), n(3), n(4), n(5)};
  };
  to.normal_place = place(m.normal_transform);
  to.occlusion_place = place(m.occlusion.transform);
  to.emission_place = place(m.emissive_map.transform);
  const auto source = [&](std::uint32_t texture, PixelMeaning meaning) {
    return texture == no_texture ? no_texture : source_of(hierarchy, texture, meaning);
  };
  to.texture = source(m.texture, PixelMeaning::colours);
  to.normal_map = source(m.normal_map, PixelMeaning::normals);
  if (m.occlusion_strength > 0) to.occlusion_map = source(m.occlusion.texture, PixelMeaning::values);
  if (to.emission != Vec3f{}) to.emission_map = source(m.emissive_map.texture, PixelMeaning::colours);
  if (to.texture != no_texture && m.alpha_mode != AlphaMode::opaque) sources_[to.texture].alpha = TexelAlpha::kept;
  return to;
}

std::uint32_t SurfaceTextures::source_of(const Hierarchy& hierarchy, std::uint32_t texture, PixelMeaning meaning) {
  for (std::uint32_t s = 0; s < sources_.size(); ++s)
    if (sources_[s].hierarchy == &hierarchy && sources_[s].texture == texture && sources_[s].meaning == meaning)
      return s;
  Source source;
  source.hierarchy = &hierarchy;
  source.texture = texture;
  source.meaning = meaning;
  const Texture& encoded = hierarchy.textures[texture];
  try {
    source.size = image_size(encoded.bytes, encoded.media_type);
  } catch (const Error& error) {
    source.size = placeholder_image().size;
    source.refusal = error.what();
  }
  sources_.push_back(source);
  textures_.push_back({{}, encoded.wrap_u, encoded.wrap_v, false});
  return static_cast<std::uint32_t>(sources_.size() - 1);
}

// Down to the longest side, then always the first of the largest until all fit.
void SurfaceTextures::reduce(const TextureLimits& limits) {
  const auto bytes_of = [](const Source& s) { return texels_of(halved(s.size, s.halvings)) * 16 / 3; };
  std::uint64_t bytes = 0;
  for (Source& s : sources_) {
    while (std::max(halved(s.size, s.halvings).width, halved(s.size, s.halvings).height) > limits.side) ++s.halvings;
    bytes += bytes_of(s);
  }
  while (bytes > limits.bytes) {
    Source& largest = *std::ranges::max_element(sources_, {}, bytes_of);
    if (texels_of(halved(largest.size, largest.halvings)) == 1) return;
    bytes -= bytes_of(largest);
    ++largest.halvings;
    bytes += bytes_of(largest);
  }
}

PixelSize SurfaceTextures::largest() const {
  PixelSize largest = placeholder_image().size;
  for (const Source& s : sources_) {
    const PixelSize size = halved(s.size, s.halvings);
    largest = {std::max(largest.width, size.width), std::max(largest.height, size.height)};
  }
  return largest;
}

std::size_t SurfaceTextures::prepare(const Frame& frame, Scheduler& scheduler) {
  std::vector<std::uint32_t> missing;
  const auto need = [&](std::uint32_t texture) {
    if (texture == no_texture || sources_[texture].decoded) return;
    sources_[texture].decoded = true;
    missing.push_back(texture);
  };
  for (const ModelFrame& model : frame.models) {
    const bool colours = shows_textures(model), normals = shows_normal_maps(model), alpha = shows_alpha(frame, model),
               occlusion = shows_occlusion_maps(model), emission = shows_emission(model);
    for (const SurfaceMaterial& material : materials_[model.model]) {
      if (colours || (alpha && material.alpha_mode != AlphaMode::opaque)) need(material.texture);
      if (normals) need(material.normal_map);
      if (occlusion) need(material.occlusion_map);
      if (emission) need(material.emission_map);
    }
  }
  scheduler.for_chunks(missing.size(), 1, [&](ChunkRange range) { decode(missing[range.begin]); });
  for (const std::uint32_t texture : missing)
    if (!sources_[texture].refusal.empty()) warn(texture);
  return missing.size();
}

// Without a normal map that cannot be decoded the surface is smooth, without an occlusion map creases are lit; without
// its colours it would look like an untextured one.
void SurfaceTextures::warn(std::uint32_t texture) {
  const Source& source = sources_[texture];
  const char* instead = source.meaning == PixelMeaning::colours   ? "it is drawn as a checker of magenta"
                        : source.meaning == PixelMeaning::normals ? "normals are drawn without it"
                                                                  : "creases are drawn without it";
  warnings_.push_back("texture '" + source.hierarchy->textures[source.texture].name + "' " + source.refusal + "; " +
                      instead);
  if (source.meaning == PixelMeaning::colours) return;
  for (std::vector<SurfaceMaterial>& materials : materials_)
    for (SurfaceMaterial& m : materials)
      for (std::uint32_t* map : {&m.normal_map, &m.occlusion_map})
        if (*map == texture) *map = no_texture;
}

void SurfaceTextures::decode(std::uint32_t texture) {
  Source& source = sources_[texture];
  SurfaceTexture& to = textures_[texture];
  PixelImage image;
  std::uint32_t halvings = 0;
  if (source.refusal.empty()) try {
      const Encoded encoded = nearest_copy(*source.hierarchy, source.texture, source.halvings);
      image = decode_image(encoded.bytes, source.hierarchy->textures[source.texture].media_type);
      halvings = encoded.halvings;
    } catch (const Error& error) {
      source.refusal = error.what();
    }
  if (!source.refusal.empty()) image = placeholder_image();
  if (source.meaning == PixelMeaning::normals) to.object_space = is_object_space(image);
  to.levels = make_mip_chain(std::move(image), source.meaning, to.wrap_u, to.wrap_v, source.alpha);
  to.levels.erase(to.levels.begin(), to.levels.begin() + std::min<std::ptrdiff_t>(halvings, std::ssize(to.levels) - 1));
}

void SurfaceTextures::release(std::uint32_t texture) {
  for (MipLevel& level : textures_[texture].levels) level.texels = {};
}

bool shows_textures(const ModelFrame& model) {
  return model.effects.contains(Effect::texture) && model.appearance.textures &&
         has_surface_colours(*model.morph.hierarchy);
}

bool shows_normal_maps(const ModelFrame& model) {
  return model.effects.contains(Effect::normal_map) && model.appearance.normal_maps &&
         has_normal_maps(*model.morph.hierarchy);
}

bool shows_occlusion_maps(const ModelFrame& model) {
  return model.effects.contains(Effect::occlusion_map) && model.appearance.textures &&
         has_occlusion_maps(*model.morph.hierarchy);
}

bool shows_emission(const ModelFrame& model) {
  return model.effects.contains(Effect::emission) && model.appearance.textures && has_emission(*model.morph.hierarchy);
}

bool shows_unlit(const ModelFrame& model) {
  return model.effects.contains(Effect::unlit) && model.appearance.textures &&
         has_unlit_materials(*model.morph.hierarchy);
}

bool shows_alpha(const Frame& frame, const ModelFrame& model, AlphaMode mode) {
  return frame.effects.contains(Effect::transparency) && model.appearance.textures &&
         has_materials_of(*model.morph.hierarchy, mode);
}

bool shows_alpha(const Frame& frame, const ModelFrame& model) {
  return shows_alpha(frame, model, AlphaMode::mask) || shows_alpha(frame, model, AlphaMode::blend);
}

}  // namespace lodestone
