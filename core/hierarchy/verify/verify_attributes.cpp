// Checks of attributes: wedges and their materials, and the copies of textures that coarser levels show, as far as they
// follow from the pixels alone, by means over them.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/base/error.h"
#include "core/hierarchy/verify/verify_checks.h"
#include "core/math/vec3.h"
#include "core/texture/colour.h"
#include "core/texture/image_codec.h"

namespace lodestone::verify {
namespace {

constexpr double mean_tolerance = 0.02;  // of light: change of a mean by lossy compression
constexpr double clear_mean = 0.2;       // of normals: shorter means have no clear direction

// Mean light and alpha, weighted with alpha; and the mean of the bytes as components of vectors.
struct Means {
  std::array<double, 4> light{};
  Vec3d vector;
};

Means means_of(const PixelImage& image) {
  Means means;
  const std::size_t n = image.channels;
  for (std::size_t p = 0; p < image.pixels.size(); p += n) {
    const double alpha = n == 4 ? image.pixels[p + 3] / 255.0 : 1;
    std::array<double, 3> components{};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint8_t byte = image.pixels[p + (n == 1 ? 0 : c)];
      means.light[c] += alpha * srgb_to_linear(byte / 255.0);
      components[c] = byte / 127.5 - 1;
    }
    means.light[3] += alpha;
    means.vector = means.vector + Vec3d{components[0], components[1], components[2]};
  }
  const double pixels = double{1} * image.size.width * image.size.height;
  for (double& value : means.light) value /= pixels;
  means.vector = (1 / pixels) * means.vector;
  return means;
}

bool same_light(const Means& a, const Means& b) {
  for (std::size_t c = 0; c < 4; ++c)
    if (std::abs(a.light[c] - b.light[c]) > mean_tolerance) return false;
  return true;
}

// For means of unit vectors: those of a halved image are longer, but have the same direction.
bool same_direction(const Means& a, const Means& b) {
  const double size = length(a.vector) * length(b.vector);
  return length(a.vector) < clear_mean || (size > 0 && dot(a.vector, b.vector) > 0.98 * size);
}

// For numbers that are averaged as they are.
bool same_values(const Means& a, const Means& b) { return length(a.vector - b.vector) <= 4 * mean_tolerance; }

// Compares means by what the texture is to the materials: colours before normals, normals before anything else.
bool same_means(const Hierarchy& hierarchy, std::uint32_t texture, const Means& a, const Means& b) {
  bool normals = false, values = false;
  for (const Material& m : hierarchy.materials) {
    if (m.texture == texture || m.emissive_map.texture == texture) return same_light(a, b);
    normals |= m.normal_map == texture;
    values |= m.metallic_roughness.texture == texture || m.occlusion.texture == texture ||
              std::ranges::count(m.extension_textures, texture) > 0;
  }
  if (normals) return same_direction(a, b);
  return values ? same_values(a, b) : same_light(a, b);
}

void require_attributes(const Part& part, int level, Finding& wedges) {
  const Hierarchy& hierarchy = part.hierarchy;
  part.for_cells(level, [&](CellId c) {
    const CellAttributes& a = hierarchy.cells[c].attributes;
    for (VertexId v{0}; v < a.uv.size(); ++v)
      wedges.require(std::isfinite(a.uv[v].x) && std::isfinite(a.uv[v].y),
                     [&] { return place(level, c, v) + ": a texture coordinate is not finite"; });
    for (VertexId v{0}; v < a.materials.size(); ++v)
      wedges.require(a.materials[v] == no_material || a.materials[v] < hierarchy.materials.size(),
                     [&] { return place(level, c, v) + ": its material does not exist"; });
  });
}

// Requires that the corners of a triangle have one material, and that P keeps it.
void require_materials_kept(const Part& part, int level, Finding& wedges) {
  part.for_cells(level, [&](CellId c) {
    const Cell& cell = part.hierarchy.cells[c];
    const auto& materials = cell.attributes.materials;
    if (materials.empty()) return;
    for (const Triangle& t : cell.triangles)
      wedges.require(materials[t.v[0]] == materials[t.v[1]] && materials[t.v[1]] == materials[t.v[2]],
                     [&] { return place(level, c) + ": a triangle has several materials"; });
    if (level == 0) return;
    // Only for vertices in use: the others may follow their vertex into another chart.
    const auto& above = part.hierarchy.cells[cell.parent].attributes.materials;
    for (const Triangle& t : cell.triangles)
      for (const std::uint32_t v : t.v)
        wedges.require(above[cell.parents[v]] == materials[v],
                       [&] { return place(level, c, VertexId(v)) + ": its parent has another material"; });
  });
}

}  // namespace

void check_wedges(const Part& part, Finding& wedges) {
  for (int level = 0; level <= part.hierarchy.finest(); ++level) {
    require_attributes(part, level, wedges);
    require_materials_kept(part, level, wedges);
  }
}

void check_textures(const Hierarchy& hierarchy, Finding& textures) {
  std::uint32_t latest = no_texture;
  Means original;
  PixelSize before;  // of the copy with one halving less
  for (const TextureCopy& copy : hierarchy.texture_copies) {
    const std::string name =
        "texture " + std::to_string(copy.texture) + ", " + std::to_string(copy.halvings) + " halvings";
    try {
      const Texture& texture = hierarchy.textures.at(copy.texture);
      if (copy.texture != latest) {
        const PixelImage image = decode_image(texture.bytes, texture.media_type);
        original = means_of(image);
        before = image.size;
        latest = copy.texture;
      }
      const PixelImage image = decode_image(copy.bytes, texture.media_type);
      const auto is_half = [](std::uint32_t half, std::uint32_t whole) { return half == whole / 2; };
      textures.require(image.size == PixelSize{copy.width, copy.height} && is_half(copy.width, before.width) &&
                           is_half(copy.height, before.height),
                       [&] { return name + ": not half the size"; });
      before = image.size;
      const Means means = means_of(image);
      textures.require(same_means(hierarchy, copy.texture, original, means),
                       [&] { return name + ": the mean of its pixels is not that of the texture"; });
    } catch (const Error& error) {
      textures.fail([&] { return name + ": " + error.what(); });
    }
  }
}

}  // namespace lodestone::verify
