#include "core/spherical/resample/mesh_source.h"

#include <array>
#include <string>

#include "core/base/disjoint_sets.h"
#include "core/base/error.h"
#include "core/mesh/vertex_of.h"
#include "core/texture/chart_cover.h"
#include "core/texture/normal_space.h"

namespace lodestone::spherical {

MeshSource::MeshSource(const IndexedMesh& mesh) : mesh_(mesh) {
  add_shades();
  find_charts();
  add_normals();
}

std::uint32_t MeshSource::loaded(std::uint32_t texture, PixelMeaning meaning) {
  if (texture == no_texture || mesh_.wedges.uv.empty()) return no_texture;
  for (std::uint32_t k = 0; k < textures_.size(); ++k)
    if (textures_[k].texture == texture && textures_[k].meaning == meaning) return k;
  textures_.push_back({texture, meaning, false, {}});
  return static_cast<std::uint32_t>(textures_.size() - 1);
}

void MeshSource::add_shades() {
  shades_.emplace_back();
  for (const Material& material : mesh_.wedges.materials) {
    const auto& c = material.base_colour;
    shades_.push_back({Float4{c[0] * c[3], c[1] * c[3], c[2] * c[3], c[3]},
                       loaded(material.texture, PixelMeaning::colours),
                       loaded(material.normal_map, PixelMeaning::normals)});
  }
}

std::uint32_t MeshSource::shade_number(std::uint32_t wedge) const {
  if (mesh_.wedges.materials.empty()) return 0;
  const std::uint32_t number = mesh_.wedges.material.empty() ? 0 : mesh_.wedges.material[wedge];
  return number == no_material ? 0 : number + 1;
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
  const PixelImage image = [&] {
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
    triangles.push_back({{mesh_.wedges.uv[i], mesh_.wedges.uv[j], mesh_.wedges.uv[k]}, charts_[i]});
  }
  to.object_space = to.meaning == PixelMeaning::normals && is_object_space(image);
  to.image = SourceTexture(image, to.meaning, from.wrap_u, from.wrap_v,
                           chart_cover(triangles, image.size, from.wrap_u, from.wrap_v));
}

}  // namespace lodestone::spherical
