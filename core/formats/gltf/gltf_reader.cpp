// Reader of glTF: the triangles of the meshes that a scene shows, primitive by primitive.
#include <algorithm>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/formats/gltf/gltf.h"
#include "core/formats/gltf/gltf_accessor.h"
#include "core/formats/gltf/gltf_document.h"
#include "core/formats/gltf/gltf_material.h"
#include "core/formats/gltf/gltf_nodes.h"
#include "core/formats/gltf/gltf_surface.h"
#include "core/formats/plain/draco.h"
#include "core/mesh/raw_mesh.h"
#include "core/texture/colour.h"

namespace lodestone {
namespace {

// Vertices and triangles that a file shows at most, also where nodes and instances repeat a few bytes without end: these,
// and so many for each byte of the file and its buffers, which suffices for 5,000 copies of most meshes.
constexpr std::uint64_t shown_always = 1 << 20, shown_per_byte = 256;

// A primitive and the source of its attributes: accessors, or a Draco mesh.
class Primitive {
 public:
  Primitive(GltfDocument& document, const JsonView& json)
      : document_(&document), json_(json), attributes_(json.at("attributes")) {
    const std::optional<JsonView> packed = extension(json, "KHR_draco_mesh_compression");
    if (!packed) return;
    draco_ids_ = packed->at("attributes");
    const GltfView view = document.view(packed->at("bufferView"));
    draco_ = std::make_unique<DracoMesh>(view.bytes, document.file(), packed->place());
  }

  [[nodiscard]] const JsonView& json() const { return json_; }

  // The values of an attribute, `components` for each vertex; empty when the primitive has no such attribute.
  [[nodiscard]] std::vector<double> values(const char* name, int components) const {
    const std::optional<JsonView> reference = attributes_.find(name);
    if (!reference) return {};
    if (draco_)
      if (const std::optional<JsonView> id = draco_ids_->find(name)) return draco_values(*id, *reference, components);
    const GltfAccessor accessor = open_accessor(*document_, *reference);
    if (accessor.components < std::min(components, 3))  // a colour may lack its alpha
      reference->fail("values of " + std::to_string(accessor.components) + " components", damaged_file);
    return read_values(accessor, components);
  }
  [[nodiscard]] int components(const char* name) const {
    return describe_accessor(document_->item("accessors", attributes_.at(name))).components;
  }

  // Without indices, vertices follow each other.
  [[nodiscard]] std::vector<Triangle> triangles(std::size_t vertices) const {
    if (draco_) return draco_->triangles();
    std::vector<std::uint32_t> ids;
    if (const std::optional<JsonView> reference = json_.find("indices")) {
      ids = read_indices(open_accessor(*document_, *reference), vertices, document_->item("accessors", *reference));
    } else {
      ids.resize(vertices);
      for (std::size_t i = 0; i < vertices; ++i) ids[i] = static_cast<std::uint32_t>(i);
    }
    return assemble(ids);
  }

  // Primitives of one mesh often share their vertices and differ in indices and material.
  [[nodiscard]] bool shares_vertices_with(const Primitive& other) const {
    return !draco_ && !other.draco_ && attributes_.json() == other.attributes_.json();
  }

 private:
  // Integers of a Draco mesh stand for fractions when the accessor says so.
  [[nodiscard]] std::vector<double> draco_values(const JsonView& id, const JsonView& accessor, int components) const {
    const auto attribute = draco_->find(static_cast<std::uint32_t>(id.integer()));
    if (!attribute) id.fail("the Draco mesh has no attribute " + std::to_string(id.integer()), damaged_file);
    std::vector<double> values = draco_->values(*attribute, components);
    const bool normalised = describe_accessor(document_->item("accessors", accessor)).normalised;
    if (normalised && !attribute->floating)
      for (double& value : values) value = std::max(value / attribute->largest, -1.0);
    return values;
  }

  [[nodiscard]] std::vector<Triangle> assemble(const std::vector<std::uint32_t>& ids) const {
    const std::uint64_t mode = json_.integer_or("mode", 4);
    std::vector<Triangle> triangles;
    if (mode == 4) {
      if (ids.size() % 3 != 0) json_.fail(std::to_string(ids.size()) + " indices do not make triangles", damaged_file);
      for (std::size_t i = 0; i + 2 < ids.size(); i += 3) triangles.push_back({{ids[i], ids[i + 1], ids[i + 2]}});
    } else if (mode == 5) {  // a strip: every other triangle is turned
      for (std::size_t i = 0; i + 2 < ids.size(); ++i)
        triangles.push_back({{ids[i], ids[i + 1 + i % 2], ids[i + 2 - i % 2]}});
    } else if (mode == 6) {  // a fan
      for (std::size_t i = 1; i + 1 < ids.size(); ++i) triangles.push_back({{ids[0], ids[i], ids[i + 1]}});
    } else {
      json_.fail("unknown mode " + std::to_string(mode), damaged_file);
    }
    return triangles;
  }

  GltfDocument* document_;
  JsonView json_, attributes_;
  std::optional<JsonView> draco_ids_;
  std::unique_ptr<DracoMesh> draco_;
};

bool is_surface(const JsonView& primitive) { return primitive.integer_or("mode", 4) > 3; }

std::vector<Vec3f> read_normals(const Primitive& primitive) {
  const std::vector<double> values = primitive.values("NORMAL", 3);
  std::vector<Vec3f> normals;
  normals.reserve(values.size() / 3);
  for (std::size_t i = 0; i < values.size(); i += 3)
    normals.push_back(unit_normal({values[i], values[i + 1], values[i + 2]}));
  return normals;
}

// Colours are linear in the file.
std::vector<Rgba8> read_colours(const Primitive& primitive) {
  const std::vector<double> values = primitive.values("COLOR_0", 4);
  const bool has_alpha = !values.empty() && primitive.components("COLOR_0") == 4;
  const auto byte = [](double linear) { return unit_to_byte(linear_to_srgb(linear)); };
  std::vector<Rgba8> colours;
  colours.reserve(values.size() / 4);
  for (std::size_t i = 0; i < values.size(); i += 4)
    colours.push_back({byte(values[i]), byte(values[i + 1]), byte(values[i + 2]),
                       has_alpha ? unit_to_byte(values[i + 3]) : std::uint8_t{255}});
  return colours;
}

std::vector<Vec2f> read_uv(const Primitive& primitive, const GltfMaterial& material) {
  const std::vector<double> values = primitive.values(material.uv_attribute.c_str(), 2);
  std::vector<Vec2f> uv;
  uv.reserve(values.size() / 2);
  for (std::size_t i = 0; i < values.size(); i += 2) uv.push_back(material.map(values[i], values[i + 1]));
  return uv;
}

class GltfReader {
 public:
  GltfReader(ByteReader& input, const ReadConfig& config)
      : document_(input), config_(config), materials_(document_, input, mesh_) {}

  RawMesh read() {
    for (const GltfMeshNode& node : list_mesh_nodes(document_)) read_node(node);
    if (left_out_ > 0) warn(std::to_string(left_out_) + " primitives of points or lines are left out");
    if (deformed_ > 0)
      warn(std::to_string(deformed_) + " nodes with a skin or morph targets are read in their pose at rest");
    for (std::string& note : materials_.finish()) mesh_.warnings.push_back(std::move(note));
    name_other_features();
    return std::move(mesh_);
  }

 private:
  // Vertices, read once, and the triangles of all primitives of a node that use them.
  struct Part {
    Primitive primitive;
    GltfMaterial material;
    RawMesh mesh;
  };

  // Names parts of the file that are not surfaces.
  void name_other_features() {
    const JsonView root = document_.root();
    const auto name = [&](const JsonView& from, const char* key, const char* what) {
      const std::optional<JsonView> items = from.find(key);
      if (items && items->json().is_array() && !items->json().empty())
        warn(std::to_string(items->size()) + " " + what + " are left out");
    };
    name(root, "animations", "animations");
    name(root, "cameras", "cameras");
    if (const auto lights = extension(root, "KHR_lights_punctual")) name(*lights, "lights", "lights");
    if (const auto variants = extension(root, "KHR_materials_variants"))
      name(*variants, "variants", "variants of materials");
  }

  void read_node(const GltfMeshNode& at) {
    const JsonView node = document_.root().at("nodes").at(at.node);
    const JsonView primitives = document_.item("meshes", node.at("mesh")).at("primitives");
    std::vector<Part> parts;
    bool deformed = node.find("skin").has_value();
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const JsonView json = primitives.at(i);
      deformed = deformed || json.find("targets");
      if (is_surface(json)) {
        read_primitive(json, parts);
      } else {
        ++left_out_;
      }
    }
    deformed_ += deformed;
    const std::vector<Affine3d> instances = instances_of(document_, node);
    for (const Part& part : parts)
      count_shown(node, (std::max<std::size_t>(instances.size(), 1) - 1) * size_of(part.mesh));
    for (Part& part : parts)
      for (std::size_t k = 0; k < instances.size(); ++k) {
        RawMesh copy = k + 1 < instances.size() ? part.mesh : std::move(part.mesh);
        transform_mesh(copy, at.map * instances[k]);
        append_mesh(mesh_, std::move(copy), document_.file());
      }
  }

  static std::uint64_t size_of(const RawMesh& mesh) { return mesh.positions.size() + mesh.triangles.size(); }

  void count_shown(const JsonView& place, std::uint64_t elements) {
    shown_ += elements;
    const std::uint64_t most = shown_always + shown_per_byte * document_.size();
    if (shown_ <= most) return;
    throw ResourceError(describe(document_.file(), place.place(),
                                 "the meshes that are shown up to here have " + std::to_string(shown_) +
                                     " vertices and triangles, of at most " + std::to_string(most) +
                                     " for a file of this size",
                                 "write repeated meshes as one mesh, or split the file"));
  }

  void read_primitive(const JsonView& json, std::vector<Part>& parts) {
    Primitive primitive(document_, json);
    GltfMaterial material;
    if (const auto reference = json.find("material"); reference && config_.attributes)
      material = materials_.use(*reference);
    const auto shares = [&](const Part& part) {
      return part.primitive.shares_vertices_with(primitive) && part.material.uv_attribute == material.uv_attribute &&
             part.material.uv_map == material.uv_map;
    };
    auto part = std::find_if(parts.begin(), parts.end(), shares);
    if (part == parts.end()) {
      RawMesh vertices = read_vertices(primitive, material);
      count_shown(json, vertices.positions.size());
      part = parts.insert(part, Part{std::move(primitive), material, std::move(vertices)});
      add_triangles(*part, part->primitive, material);
    } else {
      add_triangles(*part, primitive, material);
    }
  }

  [[nodiscard]] RawMesh read_vertices(const Primitive& primitive, const GltfMaterial& material) const {
    RawMesh mesh;
    const std::vector<double> positions = primitive.values("POSITION", 3);
    mesh.positions.reserve(positions.size() / 3);
    for (std::size_t i = 0; i < positions.size(); i += 3)
      mesh.positions.push_back({positions[i], positions[i + 1], positions[i + 2]});
    if (!config_.attributes) return mesh;
    mesh.wedges.normal = read_normals(primitive);
    mesh.wedges.colour = read_colours(primitive);
    mesh.wedges.uv = read_uv(primitive, material);
    for (const std::size_t count : {mesh.wedges.normal.size(), mesh.wedges.colour.size(), mesh.wedges.uv.size()})
      if (count != 0 && count != mesh.positions.size())
        primitive.json().fail("has " + std::to_string(mesh.positions.size()) + " positions, but " +
                                  std::to_string(count) + " values of another attribute",
                              damaged_file);
    return mesh;
  }

  void add_triangles(Part& part, const Primitive& primitive, const GltfMaterial& material) {
    RawMesh& mesh = part.mesh;
    const std::vector<Triangle> triangles = primitive.triangles(mesh.positions.size());
    count_shown(primitive.json(), triangles.size());
    for (const Triangle& t : triangles)
      for (const std::uint32_t id : t.v)
        if (id >= mesh.positions.size())
          primitive.json().fail("index " + std::to_string(id) + " is out of range", damaged_file);
    mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
    add_to_misplaced(mesh, triangles, primitive, material);
    if (material.index == no_material && mesh.wedges.material.empty()) return;
    mesh.wedges.material.resize(mesh.triangles.size() - triangles.size(), no_material);
    mesh.wedges.material.resize(mesh.triangles.size(), material.index);
  }

  // Once for each primitive, however many nodes show it.
  void add_to_misplaced(const RawMesh& mesh, std::span<const Triangle> triangles, const Primitive& primitive,
                        const GltfMaterial& material) {
    if (material.misplaced.empty() || mesh.wedges.uv.empty() || !redrawn_.insert(primitive.json().place()).second)
      return;
    for (const std::size_t number : material.misplaced) {
      MisplacedMaps::Map& map = materials_.misplaced().maps()[number];
      const std::vector<Vec2f> from = read_uv(primitive, {.uv_attribute = map.uv_attribute, .uv_map = map.uv_map});
      if (from.size() != mesh.wedges.uv.size()) continue;
      for (const Triangle& t : triangles) {
        RedrawTriangle& to = map.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k)
          to.from[k] = from[t.v[k]], to.to[k] = mesh.wedges.uv[t.v[k]],
          to.positions[k] = to_float(mesh.positions[t.v[k]]);
      }
    }
  }

  void warn(const std::string& what) { mesh_.warnings.push_back(describe(document_.file(), "", what)); }

  GltfDocument document_;
  ReadConfig config_;
  RawMesh mesh_;
  GltfMaterials materials_;
  std::set<std::string> redrawn_;  // primitives whose triangles misplaced maps have
  std::uint64_t left_out_ = 0, deformed_ = 0;
  std::uint64_t shown_ = 0;  // vertices and triangles
};

}  // namespace

RawMesh read_gltf(ByteReader& input, const ReadConfig& config) { return GltfReader(input, config).read(); }

}  // namespace lodestone
