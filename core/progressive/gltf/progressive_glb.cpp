#include "core/progressive/gltf/progressive_glb.h"

#include <algorithm>
#include <cstdint>
#include <map>

#include "core/base/error.h"
#include "core/formats/common/float_range.h"
#include "core/formats/gltf/glb_builder.h"
#include "core/math/round_up.h"
#include "core/mesh/up_axis.h"
#include "core/progressive/mesh/octahedral_layout.h"
#include "core/texture/colour.h"

namespace lodestone {
namespace {

// Extras say where the model lies before it is turned y up.
void add_place(GlbBuilder& glb, const Transform& t) {
  glb.add_node(t.origin, t.scale, t.up.axis);
  glb.root["nodes"][0]["extras"] = {{"up", name_of(t.up.axis)}, {"origin", {t.origin.x, t.origin.y, t.origin.z}}};
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
Json add_vertices(GlbBuilder& glb, const ProgressiveMesh& mesh) {
  const auto add = [&]<class T>(const std::vector<T>& values, GltfComponent component, const char* type) {
    return glb.add_accessor(std::span(values), component, type, GltfTarget::vertices);
  };
  Json attributes{{"POSITION", glb.add_positions(mesh.positions)}};
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
  if (!mesh.tangents.empty()) attributes["TANGENT"] = add(mesh.tangents, GltfComponent::floats, "VEC4");
  if (!wedges.uv.empty()) attributes["TEXCOORD_0"] = add(wedges.uv, GltfComponent::floats, "VEC2");
  if (!wedges.colour.empty()) {
    std::vector<LinearColour> colours;
    for (const Rgba8 c : wedges.colour) colours.push_back(linear_colour(c));
    attributes["COLOR_0"] = add(colours, GltfComponent::unsigned_short, "VEC4");
    glb.root["accessors"][attributes["COLOR_0"].get<std::size_t>()]["normalized"] = true;
  }
  return attributes;
}

void add_primitives(GlbBuilder& glb, const ProgressiveMesh& mesh, const Json& attributes) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> by_material;
  const std::uint32_t only = mesh.wedges.materials.empty() ? no_material : 0;
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t material = mesh.wedges.material.empty() ? only : mesh.wedges.material[t.v[0]];
    std::vector<std::uint32_t>& ids = by_material[material];
    ids.insert(ids.end(), t.v.begin(), t.v.end());
  }
  for (const auto& [material, ids] : by_material) {
    Json primitive{{"attributes", attributes}, {"indices", glb.add_indices(ids, mesh.positions.size())}};
    if (material < mesh.wedges.materials.size()) primitive["material"] = material;
    glb.root["meshes"][0]["primitives"].push_back(std::move(primitive));
  }
  glb.root["meshes"][0]["extras"] = {{"progressive",
                                      {{"version", 1},
                                       {"baseVertices", mesh.base_vertices},
                                       {"finestError", product_up(mesh.finest_error, mesh.transform.scale)}}}};
}

// Thumbnails and images without one come first.
void add_textures(GlbBuilder& glb, const std::vector<Texture>& textures, std::span<const Texture> thumbnails) {
  const auto add = [&](const Texture& t) { return glb.add_view(std::as_bytes(std::span(t.bytes)), GltfTarget::none); };
  const auto has_copy = [&](std::size_t k) {
    return k < thumbnails.size() && !thumbnails[k].bytes.empty() && thumbnails[k].bytes != textures[k].bytes;
  };
  std::vector<std::size_t> small;
  for (std::size_t k = 0; k < textures.size(); ++k) small.push_back(add(has_copy(k) ? thumbnails[k] : textures[k]));
  for (std::size_t k = 0; k < textures.size(); ++k) {
    glb.add_embedded_texture(textures[k], has_copy(k) ? add(textures[k]) : small[k]);
    if (has_copy(k))
      glb.root["textures"].back()["extras"]["thumbnail"] = {{"bufferView", small[k]},
                                                            {"mimeType", thumbnails[k].media_type}};
  }
}

void add_extras(GlbBuilder& glb, const ProgressiveMesh& mesh) {
  if (mesh.wedges.materials.empty()) return;  // glTF has no empty list of materials
  Json& materials = glb.root["materials"];
  for (std::size_t m = 0; m < mesh.object_normals.size(); ++m)
    if (mesh.object_normals[m] != no_texture)
      materials[m]["extras"]["objectNormalTexture"]["index"] = mesh.object_normals[m];
  for (std::size_t m = 0; m < mesh.geometry_images.size(); ++m)
    if (const GeometryTexture& image = mesh.geometry_images[m]; image.texture != no_texture)
      materials[m]["extras"]["geometryImageTexture"] = {
          {"index", image.texture}, {"origin", {image.origin.x, image.origin.y, image.origin.z}}, {"step", image.step}};
  for (std::size_t m = 0; m < mesh.octahedral.size(); ++m)
    if (mesh.octahedral[m]) materials[m]["extras"]["octahedral"] = to_json(*mesh.octahedral[m]);
}

}  // namespace

std::vector<std::byte> encode_progressive_glb(const ProgressiveMesh& mesh, bool compressed,
                                              std::span<const Texture> thumbnails) {
  require_gltf_range({mesh.transform.to_model({0, 0, 0}), mesh.transform.to_model({1, 1, 1})}, "", "write a .lpm file");
  GlbBuilder glb;
  add_place(glb, mesh.transform);
  add_primitives(glb, mesh, add_vertices(glb, mesh));
  for (const Material& m : mesh.wedges.materials) glb.add_material(m, mesh.wedges.textures.size());
  add_extras(glb, mesh);
  glb.complete_materials();
  add_textures(glb, mesh.wedges.textures, thumbnails);
  return compressed ? glb.finish_compressed() : glb.finish();
}

}  // namespace lodestone
