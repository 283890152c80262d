// Writer of whole meshes as binary glTF.
#include <map>

#include "core/formats/gltf/glb_builder.h"
#include "core/formats/gltf/gltf.h"
#include "core/texture/colour.h"

namespace lodestone {
namespace {

// Colours are sRGB in files of meshes and linear in glTF.
std::vector<std::array<float, 4>> linear_colours(const std::vector<Rgba8>& colours) {
  const std::array<float, 256>& linear = linear_of_srgb();
  std::vector<std::array<float, 4>> out(colours.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Rgba8 c = colours[i];
    out[i] = {linear[c.r], linear[c.g], linear[c.b], static_cast<float>(c.a) / 255};
  }
  return out;
}

// Returns the "attributes" of all primitives.
Json add_vertices(GlbBuilder& glb, const MeshView& mesh, Vec3d middle) {
  std::vector<Vec3f> positions(mesh.vertex_count);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = to_float(mesh.position(i) - middle);
  Json attributes{{"POSITION", glb.add_positions(positions)}};
  const auto add = [&]<class T>(const char* name, const std::vector<T>& values, const char* type) {
    if (!values.empty())
      attributes[name] = glb.add_accessor(std::span(values), GltfComponent::floats, type, GltfTarget::vertices);
  };
  if (mesh.wedges == nullptr) return attributes;
  add("NORMAL", mesh.wedges->normal, "VEC3");
  add("TEXCOORD_0", mesh.wedges->uv, "VEC2");
  add("COLOR_0", linear_colours(mesh.wedges->colour), "VEC4");
  return attributes;
}

void add_primitives(GlbBuilder& glb, const MeshView& mesh, const Json& attributes) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> by_material;
  const bool has_materials = mesh.wedges != nullptr && !mesh.wedges->material.empty();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::vector<std::uint32_t>& ids = by_material[has_materials ? mesh.wedges->material[t] : no_material];
    ids.insert(ids.end(), mesh.triangles[t].v.begin(), mesh.triangles[t].v.end());
  }
  for (const auto& [material, ids] : by_material) {
    Json primitive{
        {"attributes", attributes},
        {"indices", glb.add_accessor(std::span(ids), GltfComponent::unsigned_int, "SCALAR", GltfTarget::indices)}};
    if (material < mesh.materials.size()) primitive["material"] = material;
    glb.root["meshes"][0]["primitives"].push_back(std::move(primitive));
  }
}

}  // namespace

std::vector<std::byte> encode_glb(const MeshView& mesh) {
  const auto [lo, hi] = box_of(mesh);
  const Vec3d middle = 0.5 * (lo + hi);
  GlbBuilder glb;
  glb.add_node(middle, 1, mesh.up.axis);
  add_primitives(glb, mesh, add_vertices(glb, mesh, middle));
  for (const Material& m : mesh.materials) glb.add_material(m, mesh.textures.size());
  glb.complete_materials();
  for (const Texture& t : mesh.textures) glb.add_embedded_texture(t);
  return glb.finish();
}

}  // namespace lodestone
