#include "core/spherical/resample/mesh_source.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/base/disjoint_sets.h"
#include "core/base/error.h"
#include "core/formats/gltf/gltf_surface.h"
#include "core/mesh/vertex_of.h"
#include "core/texture/chart_cover.h"
#include "core/texture/normal_space.h"

namespace lodestone::spherical {
namespace {

void make_opaque(PixelImage& image) {
  for (std::size_t p = 3; image.channels == 4 && p < image.pixels.size(); p += 4) image.pixels[p] = 255;
}

}  // namespace

float strongest_emission(const IndexedMesh& mesh) {
  float strongest = 1;
  for (const Material& m : mesh.wedges.materials) strongest = std::max(strongest, emissive_strength(m));
  return strongest;
}

MeshSource::MeshSource(const IndexedMesh& mesh, SourceLook look) : mesh_(mesh), look_(look) {
  shades_.push_back(shade_of({}));
  for (const Material& material : mesh.wedges.materials) shades_.push_back(shade_of(material));
  find_charts();
  add_normals();
}

std::uint32_t MeshSource::loaded(std::uint32_t texture, PixelMeaning meaning, bool opaque) {
  if (texture == no_texture || mesh_.wedges.uv.empty()) return no_texture;
  for (std::uint32_t k = 0; k < textures_.size(); ++k)
    if (textures_[k].texture == texture && textures_[k].meaning == meaning && textures_[k].opaque == opaque) return k;
  textures_.push_back({texture, meaning, opaque});
  return static_cast<std::uint32_t>(textures_.size() - 1);
}

MeshSource::Shade MeshSource::shade_of(const Material& m) {
  Shade s;
  const auto show = [&](const PlacedTexture& map, PixelMeaning meaning) {
    s.texture = loaded(map.texture, meaning, true);
    s.place = map_of(map.transform);
  };
  switch (look_) {
    case SourceLook::colours_and_normals: {
      s.opaque = m.alpha_mode == AlphaMode::opaque;
      const auto& c = m.base_colour;
      const float alpha = s.opaque ? 1 : c[3];
      s.factor = Float4{c[0] * alpha, c[1] * alpha, c[2] * alpha, alpha};
      s.texture = loaded(m.texture, PixelMeaning::colours, s.opaque);
      s.normal_map = loaded(m.normal_map, PixelMeaning::normals, true);
      break;
    }
    case SourceLook::metal_and_roughness:
      s.factor = Float4{1, m.roughness, m.metallic, 1};
      show(m.metallic_roughness, PixelMeaning::values);
      break;
    case SourceLook::occlusion:
      s.factor = all4(m.occlusion_strength), s.added = all4(1 - m.occlusion_strength);
      show(m.occlusion, PixelMeaning::values);
      break;
    case SourceLook::emission: {
      const float share = m.unlit ? 0 : emissive_strength(m) / strongest_emission(mesh_);
      s.factor = Float4{share * m.emissive[0], share * m.emissive[1], share * m.emissive[2], 1};
      show(m.emissive_map, PixelMeaning::colours);
      break;
    }
  }
  return s;
}

std::uint32_t MeshSource::shade_number(std::uint32_t wedge) const {
  if (mesh_.wedges.materials.empty()) return 0;
  const std::uint32_t number = mesh_.wedges.material.empty() ? 0 : mesh_.wedges.material[wedge];
  return number == no_material ? 0 : number + 1;
}

Vec2f MeshSource::uv(std::uint32_t wedge) const {
  const Vec2f at = mesh_.wedges.uv[wedge];
  const auto [a, b, c, d, x, y] = shades_[shade_number(wedge)].place;
  return {static_cast<float>(a * at.x + b * at.y + x), static_cast<float>(c * at.x + d * at.y + y)};
}

// Wedges are shared within a chart.
void MeshSource::find_charts() {
  DisjointSets charts(mesh_.positions.size());
  for (const Triangle& corners : mesh_.triangles) {
    charts.unite(corners.v[0], corners.v[1]);
    charts.unite(corners.v[1], corners.v[2]);
  }
  charts_.resize(charts.size());
  for (std::uint32_t w = 0; w < charts_.size(); ++w) charts_[w] = charts.find(w);
}

void MeshSource::add_normals() {
  std::vector<Vec3d> sums(mesh_.positions.size());
  for (const Triangle& corners : mesh_.triangles) {
    const auto& [i, j, k] = corners.v;
    const Vec3d a = to_double(mesh_.positions[i]), b = to_double(mesh_.positions[j]), c = to_double(mesh_.positions[k]);
    for (const std::uint32_t wedge : corners.v) {
      Vec3d& sum = sums[vertex_of(mesh_, wedge)];
      sum = sum + cross(b - a, c - a);
    }
  }
  normals_.resize(sums.size());
  for (std::uint32_t w = 0; w < normals_.size(); ++w) {
    if (!mesh_.wedges.normal.empty()) {
      const float given = length(mesh_.wedges.normal[w]);
      if (given > 0) normals_[w] = (1 / given) * mesh_.wedges.normal[w];
    }
    const Vec3d sum = sums[vertex_of(mesh_, w)];
    const double size = length(sum);
    if (normals_[w] == Vec3f{} && size > 0) normals_[w] = to_float((1 / size) * sum);
  }
}

void MeshSource::load(std::size_t texture) {
  LoadedTexture& to = textures_[texture];
  const Texture& from = mesh_.wedges.textures[to.texture];
  PixelImage image = [&] {
    try {
      return decode_image(from.bytes, from.media_type);
    } catch (const UnsupportedError& error) {
      throw UnsupportedError("texture '" + from.name + "' " + error.what());
    } catch (const InputError& error) {
      throw InputError("texture '" + from.name + "' " + error.what());
    }
  }();
  std::vector<ChartTriangle> triangles;
  for (const Triangle& corners : mesh_.triangles) {
    const auto& [i, j, k] = corners.v;
    const Shade& shade_there = shades_[shade_number(i)];
    if (shade_there.texture != texture && shade_there.normal_map != texture) continue;
    triangles.push_back({{uv(i), uv(j), uv(k)}, charts_[i]});
  }
  if (to.opaque) make_opaque(image);
  to.object_space = to.meaning == PixelMeaning::normals && is_object_space(image);
  to.image = SourceTexture(image, to.meaning, from.wrap_u, from.wrap_v,
                           chart_cover(triangles, image.size, from.wrap_u, from.wrap_v));
}

}  // namespace lodestone::spherical
