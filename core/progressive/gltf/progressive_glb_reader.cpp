#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/files/byte_reader.h"
#include "core/formats/gltf/gltf_accessor.h"
#include "core/formats/gltf/gltf_document.h"
#include "core/formats/gltf/gltf_material.h"
#include "core/math/round_up.h"
#include "core/mesh/up_axis.h"
#include "core/progressive/gltf/progressive_glb.h"
#include "core/progressive/mesh/activation.h"
#include "core/progressive/mesh/octahedral_layout.h"
#include "core/texture/colour.h"

namespace lodestone {
namespace {

class ProgressiveReader {
 public:
  explicit ProgressiveReader(ByteReader& input) : document_(input), materials_(document_, input, assets_) {}

  ProgressiveMesh read() {
    const JsonView root = document_.root();
    const JsonView node = root.at("nodes").at(std::size_t{0});
    const JsonView mesh = document_.item("meshes", node.at("mesh"));
    const JsonView primitives = mesh.at("primitives");
    const JsonView attributes = primitives.at(std::size_t{0}).at("attributes");
    if (!attributes.find("_PARENTINDEX"))
      attributes.fail("the model is not progressive: it has no attribute _PARENTINDEX",
                      "make it so with `lodestone progressive`");
    read_place(node);
    read_vertices(attributes);
    const JsonView extras = mesh.at("extras").at("progressive");
    const std::uint64_t base = extras.at("baseVertices").integer();
    if (base > out_.positions.size()) mesh.at("extras").fail("the base has more vertices than the model");
    out_.base_vertices = static_cast<std::uint32_t>(base);
    if (const auto error = extras.find("finestError"))
      out_.finest_error = quotient_up(error->number(), out_.transform.scale);
    for (std::size_t k = 0; k < primitives.size(); ++k) read_primitive(primitives.at(k), attributes);
    out_.wedges.materials = std::move(assets_.materials);
    out_.wedges.textures = std::move(assets_.textures);
    if (all_have_the_first_material()) out_.wedges.material.clear();
    if (!out_.object_normals.empty()) out_.object_normals.resize(out_.wedges.materials.size(), no_texture);
    if (!out_.geometry_images.empty()) out_.geometry_images.resize(out_.wedges.materials.size());
    if (!out_.octahedral.empty()) out_.octahedral.resize(out_.wedges.materials.size());
    check_progressive(out_, document_.file());
    progressive::sort_by_activation(out_);
    return std::move(out_);
  }

 private:
  void read_place(const JsonView& node) {
    const auto origin = node.numbers_or<3>("translation", {0, 0, 0});
    const auto scale = node.numbers_or<3>("scale", {1, 1, 1});
    if (!(scale[0] > 0) || scale[0] != scale[1] || scale[1] != scale[2]) node.fail("the scale is not uniform");
    const std::optional<JsonView> extras = node.find("extras");  // the place before the turn to y up
    const auto own = extras ? extras->numbers_or<3>("origin", origin) : origin;
    const std::optional<UpAxis> up = up_axis_named(extras ? extras->string_or("up", "y") : "y");
    if (!up) extras->fail("unknown up axis");
    out_.transform.origin = {own[0], own[1], own[2]};
    out_.transform.up = {*up, false};
    out_.transform.scale = scale[0];
  }

  [[nodiscard]] std::vector<double> values(const JsonView& attributes, const char* name, int components) {
    const std::optional<JsonView> reference = attributes.find(name);
    if (!reference) return {};
    const GltfAccessor accessor = open_accessor(document_, *reference);
    if (accessor.components != components)
      reference->fail("values of " + std::to_string(accessor.components) + " components");
    if (!out_.positions.empty() && accessor.count != out_.positions.size())
      reference->fail(std::to_string(accessor.count) + " values for " + std::to_string(out_.positions.size()) +
                      " vertices");
    return read_values(accessor, components);
  }

  void read_vertices(const JsonView& attributes) {
    const auto place = attributes.at("POSITION");
    const std::vector<double> p = values(attributes, "POSITION", 3);
    if (p.empty()) place.fail("there are no vertices");
    for (std::size_t k = 0; k < p.size(); k += 3) out_.positions.push_back(to_float({p[k], p[k + 1], p[k + 2]}));
    const JsonView parents = attributes.at("_PARENTINDEX");
    for (const double value : values(attributes, "_PARENTINDEX", 1)) {
      if (!(value >= 0 && value < static_cast<double>(out_.positions.size())))
        parents.fail("a parent index is out of range");
      out_.parents.push_back(static_cast<std::uint32_t>(value));
    }
    (void)attributes.at("_ERROR");
    for (const double e : values(attributes, "_ERROR", 1))
      out_.errors.push_back(static_cast<float>(e / out_.transform.scale));
    WedgeAttributes& wedges = out_.wedges;
    const std::vector<double> n = values(attributes, "NORMAL", 3), uv = values(attributes, "TEXCOORD_0", 2),
                              c = values(attributes, "COLOR_0", 4), t = values(attributes, "TANGENT", 4);
    for (std::size_t k = 0; k < n.size(); k += 3) wedges.normal.push_back(to_float({n[k], n[k + 1], n[k + 2]}));
    for (std::size_t k = 0; k < t.size(); k += 4)
      out_.tangents.push_back({to_float({t[k], t[k + 1], t[k + 2]}), static_cast<float>(t[k + 3])});
    for (std::size_t k = 0; k < uv.size(); k += 2)
      wedges.uv.push_back({static_cast<float>(uv[k]), static_cast<float>(uv[k + 1])});
    for (std::size_t k = 0; k < c.size(); k += 4)
      wedges.colour.push_back(colour_of_linear(c[k], c[k + 1], c[k + 2], c[k + 3]));
    wedges.material.assign(out_.positions.size(), no_material);
  }

  void read_primitive(const JsonView& primitive, const JsonView& attributes) {
    if (primitive.at("attributes").json() != attributes.json())
      primitive.fail("does not share the vertices of the first primitive");
    if (primitive.integer_or("mode", 4) != 4) primitive.fail("is not a list of triangles");
    std::uint32_t material = no_material;
    if (const auto reference = primitive.find("material")) {
      material = materials_.use(*reference).index;
      read_extras(document_.item("materials", *reference), material);
    }
    const JsonView reference = primitive.at("indices");
    const std::vector<std::uint32_t> ids =
        read_indices(open_accessor(document_, reference), out_.positions.size(), reference);
    if (ids.size() % 3 != 0) reference.fail(std::to_string(ids.size()) + " indices do not form triangles");
    for (std::size_t k = 0; k < ids.size(); k += 3) {
      out_.triangles.push_back({ids[k], ids[k + 1], ids[k + 2]});
      for (std::size_t c = k; c < k + 3; ++c) out_.wedges.material[ids[c]] = material;
    }
  }

  [[nodiscard]] bool all_have_the_first_material() const {
    const std::size_t count = out_.wedges.materials.size();
    return count == 0 || (count == 1 && std::ranges::all_of(out_.triangles, [&](const Triangle& t) {
                            return out_.wedges.material[t.v[0]] == 0;
                          }));
  }

  void read_extras(const JsonView& source, std::uint32_t material) {
    const auto extras = source.find("extras");
    if (!extras) return;
    if (const auto info = extras->find("objectNormalTexture")) {
      out_.object_normals.resize(std::max<std::size_t>(out_.object_normals.size(), material + 1), no_texture);
      out_.object_normals[material] = materials_.read_texture(*info);
    }
    if (const auto info = extras->find("geometryImageTexture")) {
      out_.geometry_images.resize(std::max<std::size_t>(out_.geometry_images.size(), material + 1));
      const auto origin = info->at("origin").numbers<3>();
      out_.geometry_images[material] = {
          materials_.read_texture(*info), {origin[0], origin[1], origin[2]}, info->at("step").number()};
    }
    if (const auto layout = extras->find("octahedral")) {
      out_.octahedral.resize(std::max<std::size_t>(out_.octahedral.size(), material + 1));
      out_.octahedral[material] = read_octahedral_layout(*layout);
    }
  }

  GltfDocument document_;
  RawMesh assets_;
  GltfMaterials materials_;
  ProgressiveMesh out_;
};

}  // namespace

ProgressiveMesh read_progressive_glb(ByteReader& input) { return ProgressiveReader(input).read(); }

}  // namespace lodestone
