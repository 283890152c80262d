#include "core/progressive/gltf/progressive_glb.h"

#include <algorithm>
#include <cstdint>
#include <map>

#include "core/base/error.h"
#include "core/formats/common/colour.h"
#include "core/formats/gltf/glb_builder.h"

namespace lodestone {
namespace {

using nlohmann::json;

void add_node(GlbBuilder& glb, const Transform& t) {
  glb.root["scene"] = 0;
  glb.root["scenes"] = {{{"nodes", {0}}}};
  glb.root["nodes"] = {
      {{"mesh", 0}, {"translation", {t.origin.x, t.origin.y, t.origin.z}}, {"scale", {t.scale, t.scale, t.scale}}}};
}

// glTF has no attributes of 32-bit unsigned integers: 16 bits where they suffice, else floats, exact up to 2^24.
std::size_t add_parents(GlbBuilder& glb, const std::vector<std::uint32_t>& parents) {
  if (parents.size() <= 0xffff)
    return glb.add_vertex_shorts(std::vector<std::uint16_t>(parents.begin(), parents.end()));
  if (parents.size() > std::size_t{1} << 24)
    throw ResourceError(
        describe("", "", std::to_string(parents.size()) + " vertices, more than glTF can number", "write a .lpm file"));
  const std::vector<float> numbers(parents.begin(), parents.end());
  return glb.add_accessor(std::span(numbers), GltfComponent::floats, "SCALAR", GltfTarget::vertices);
}

// Returns the attributes of all primitives.
json add_vertices(GlbBuilder& glb, const ProgressiveMesh& mesh) {
  const auto add = [&]<class T>(const std::vector<T>& values, GltfComponent component, const char* type) {
    return glb.add_accessor(std::span(values), component, type, GltfTarget::vertices);
  };
  json attributes{{"POSITION", glb.add_positions(mesh.positions)}};
  attributes["_PARENTINDEX"] = add_parents(glb, mesh.parents);
  std::vector<float> errors;
  for (const float e : mesh.errors) errors.push_back(static_cast<float>(e * mesh.transform.scale));
  attributes["_ERROR"] = add(errors, GltfComponent::floats, "SCALAR");
  const WedgeAttributes& wedges = mesh.wedges;
  if (!wedges.normal.empty()) {  // of unit length in glTF, so that an unknown one is any
    std::vector<Vec3f> normals = wedges.normal;
    std::replace(normals.begin(), normals.end(), Vec3f{}, Vec3f{0, 0, 1});
    attributes["NORMAL"] = add(normals, GltfComponent::floats, "VEC3");
  }
  if (!wedges.uv.empty()) attributes["TEXCOORD_0"] = add(wedges.uv, GltfComponent::floats, "VEC2");
  if (!wedges.colour.empty()) {
    std::vector<LinearColour> colours;
    for (const Rgba8 c : wedges.colour) colours.push_back(linear_colour(c));
    attributes["COLOR_0"] = add(colours, GltfComponent::unsigned_short, "VEC4");
    glb.root["accessors"][attributes["COLOR_0"].get<std::size_t>()]["normalized"] = true;
  }
  return attributes;
}

void add_primitives(GlbBuilder& glb, const ProgressiveMesh& mesh, const json& attributes) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> by_material;
  const std::uint32_t only = mesh.wedges.materials.empty() ? no_material : 0;
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t material = mesh.wedges.material.empty() ? only : mesh.wedges.material[t.v[0]];
    std::vector<std::uint32_t>& ids = by_material[material];
    ids.insert(ids.end(), t.v.begin(), t.v.end());
  }
  for (const auto& [material, ids] : by_material) {
    json primitive{{"attributes", attributes}, {"indices", glb.add_indices(ids, mesh.positions.size())}};
    if (material < mesh.wedges.materials.size()) primitive["material"] = material;
    glb.root["meshes"][0]["primitives"].push_back(std::move(primitive));
  }
  glb.root["meshes"][0]["extras"] = {{"progressive", {{"version", 1}, {"baseVertices", mesh.base_vertices}}}};
}

}  // namespace

std::vector<std::byte> encode_progressive_glb(const ProgressiveMesh& mesh, bool compressed) {
  GlbBuilder glb;
  add_node(glb, mesh.transform);
  add_primitives(glb, mesh, add_vertices(glb, mesh));
  for (const Material& m : mesh.wedges.materials) glb.add_material(m, mesh.wedges.textures.size());
  for (std::size_t m = 0; m < mesh.object_normals.size(); ++m)
    if (mesh.object_normals[m] != no_texture)
      glb.root["materials"][m]["extras"]["objectNormalTexture"]["index"] = mesh.object_normals[m];
  for (const Texture& t : mesh.wedges.textures) glb.add_embedded_texture(t);
  return compressed ? glb.finish_compressed() : glb.finish();
}

}  // namespace lodestone
