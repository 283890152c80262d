#include "core/hierarchy/model/level_mesh.h"

#include <algorithm>
#include <string>
#include <unordered_map>

#include "core/base/error.h"
#include "core/texture/downsample.h"

namespace lodestone {
namespace {

constexpr std::uint32_t unseen = 0xffff'ffffu;

const Level& level_or_throw(const Hierarchy& hierarchy, int level) {
  if (level < 0 || level > hierarchy.finest())
    throw InputError(describe("", "level " + std::to_string(level), "the level does not exist",
                              "give one from 0 to " + std::to_string(hierarchy.finest())));
  const Level& found = hierarchy.levels[static_cast<std::size_t>(level)];
  if (found.vertices >= unseen)
    throw ResourceError(
        describe("", "level " + std::to_string(level), "has more than 2^32 vertices", "export a coarser level"));
  return found;
}

void append_attributes(const Hierarchy& hierarchy, const Cell& cell, std::uint32_t v, RawWedges& out) {
  out.normal.push_back(unpack_normal(cell.normals[v]));
  if (hierarchy.attributes.uv) out.uv.push_back(cell.attributes.uv[v]);
  if (hierarchy.attributes.colours) out.colour.push_back(cell.attributes.colours[v]);
}

// Colours and normals go before what is only carried.
PixelMeaning meaning_of(const Hierarchy& hierarchy, std::uint32_t texture) {
  bool colours = false, normals = false, values = false;
  for (const Material& m : hierarchy.materials) {
    colours = colours || m.texture == texture || m.emissive_map.texture == texture;
    normals = normals || m.normal_map == texture;
    for_each_texture(m, [&](std::uint32_t used) { values = values || used == texture; });
  }
  if (colours || !values) return PixelMeaning::colours;
  return normals ? PixelMeaning::normals : PixelMeaning::values;
}

}  // namespace

RawMesh level_mesh(const Hierarchy& hierarchy, int level) {
  const Level& found = level_or_throw(hierarchy, level);
  RawMesh mesh;
  mesh.up = hierarchy.transform.up;
  mesh.triangles.reserve(found.triangles);
  mesh.materials = hierarchy.materials;
  mesh.textures = level_textures(hierarchy, level);
  const bool attributed = hierarchy.attributes != AttributeSet{} || !hierarchy.materials.empty();
  std::unordered_map<std::uint32_t, std::uint32_t> by_id;  // of the shared vertices
  std::vector<std::uint32_t> numbers;                      // of the cell's vertices in `mesh`
  const auto add = [&](const Cell& cell, std::uint32_t v) {
    const auto next = static_cast<std::uint32_t>(mesh.positions.size());
    if (v >= cell.first_shared()) {
      const auto [at, fresh] = by_id.emplace(cell.shared_ids[v - cell.first_shared()], next);
      if (!fresh) return at->second;
    }
    mesh.positions.push_back(hierarchy.transform.to_model(cell.positions[v]));
    if (attributed) append_attributes(hierarchy, cell, v, mesh.wedges);
    return next;
  };
  for (const Cell& cell : hierarchy.cells_of(level)) {
    numbers.assign(cell.positions.size(), unseen);
    for (const Triangle& t : cell.triangles) {
      Triangle& out = mesh.triangles.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) {
        std::uint32_t& number = numbers[t.v[i]];
        if (number == unseen) number = add(cell, t.v[i]);
        out.v[i] = number;
      }
      if (hierarchy.attributes.materials)
        mesh.wedges.material.push_back(cell.attributes.materials[t.v[0]]);
      else if (!hierarchy.materials.empty())
        mesh.wedges.material.push_back(0);
    }
  }
  return mesh;
}

std::vector<TextureCopy> make_texture_copies(const Hierarchy& hierarchy, std::uint32_t texture, int count) {
  std::vector<TextureCopy> copies;
  const Texture& source = hierarchy.textures[texture];
  const auto fits = [](PixelSize size) { return std::min(size.width, size.height) >= 2 * min_texture_side; };
  if (count < 1 || !fits(image_size(source.bytes, source.media_type))) return copies;
  const PixelMeaning meaning = meaning_of(hierarchy, texture);
  PixelImage pixels = decode_image(source.bytes, source.media_type);
  const int chroma = pixels.chroma;
  LinearImage image = to_linear(pixels, meaning);
  pixels = {};
  for (std::uint32_t halvings = 1; halvings <= static_cast<std::uint32_t>(count) && fits(image.size); ++halvings) {
    image = halve(image);
    PixelImage half = to_pixels(image, meaning);
    half.chroma = chroma;
    copies.push_back({texture, halvings, image.size.width, image.size.height, encode_image(half, source.media_type)});
  }
  return copies;
}

const TextureCopy* texture_copy(const Hierarchy& hierarchy, std::uint32_t texture, int level) {
  const auto halvings = static_cast<std::uint32_t>(hierarchy.doublings(level));
  const TextureCopy* best = nullptr;
  for (const TextureCopy& copy : hierarchy.texture_copies)
    if (copy.texture == texture && copy.halvings <= halvings) best = &copy;
  return best;
}

std::vector<Texture> level_textures(const Hierarchy& hierarchy, int level) {
  std::vector<Texture> textures = hierarchy.textures;
  for (std::uint32_t t = 0; t < textures.size(); ++t)
    if (const TextureCopy* copy = texture_copy(hierarchy, t, level)) textures[t].bytes = copy->bytes;
  return textures;
}

}  // namespace lodestone
