#include "core/formats/gltf/gltf_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/formats/gltf/gltf_accessor.h"
#include "core/formats/gltf/gltf_surface.h"

namespace lodestone {
namespace {

// Columns of the rotation by a quaternion (x, y, z, w), whatever its length.
std::array<Vec3d, 3> rotation_axes(const JsonView& node, const std::array<double, 4>& q) {
  const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(square > 0) || !std::isfinite(square)) node.fail("the rotation is not a valid quaternion");
  const double x = q[0], y = q[1], z = q[2], w = q[3], s = 2 / square;
  return {Vec3d{1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)},
          Vec3d{s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)},
          Vec3d{s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)}};
}

// Translation, rotation and scale: of a node, or of an instance of its mesh.
struct Placement {
  std::array<double, 3> translation{0, 0, 0}, scale{1, 1, 1};
  std::array<double, 4> rotation{0, 0, 0, 1};
  [[nodiscard]] Affine3d map(const JsonView& node) const {
    Affine3d map{rotation_axes(node, rotation), {translation[0], translation[1], translation[2]}};
    for (std::size_t i = 0; i < 3; ++i) map.axes[i] = scale[i] * map.axes[i];
    return map;
  }
};

Affine3d map_of(const JsonView& node) {
  if (const std::optional<JsonView> matrix = node.find("matrix")) return affine_of(*matrix);
  const Placement own;
  return Placement{node.numbers_or<3>("translation", own.translation), node.numbers_or<3>("scale", own.scale),
                   node.numbers_or<4>("rotation", own.rotation)}
      .map(node);
}

// Values that hold the indices of the root nodes of the default scene.
std::vector<JsonView> scene_roots(const GltfDocument& document) {
  const JsonView root = document.root();
  std::vector<JsonView> roots;
  const std::optional<JsonView> scenes = root.find("scenes");
  if (!scenes || scenes->size() == 0) return roots;
  const std::optional<JsonView> chosen = root.find("scene");
  const JsonView scene = chosen ? document.item("scenes", *chosen) : scenes->at(std::size_t{0});
  if (const std::optional<JsonView> nodes = scene.find("nodes"))
    for (std::size_t i = 0; i < nodes->size(); ++i) roots.push_back(nodes->at(i));
  return roots;
}

// A node to be visited.
struct Pending {
  std::size_t node;
  Affine3d parent;
  std::string place;  // of the reference to it
};

std::vector<Pending> first_nodes(const GltfDocument& document, const JsonView& nodes) {
  std::vector<Pending> pending;
  if (const auto scenes = document.root().find("scenes"); scenes && scenes->size() > 0) {
    for (const JsonView& reference : scene_roots(document)) {
      (void)document.item("nodes", reference);
      pending.push_back({static_cast<std::size_t>(reference.integer()), {}, reference.place()});
    }
    return pending;
  }
  std::vector<bool> is_child(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::optional<JsonView> children = nodes.at(i).find("children");
    for (std::size_t k = 0; children && k < children->size(); ++k) {
      (void)document.item("nodes", children->at(k));
      is_child[static_cast<std::size_t>(children->at(k).integer())] = true;
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (!is_child[i]) pending.push_back({i, {}, nodes.at(i).place()});
  return pending;
}

}  // namespace

std::vector<GltfMeshNode> list_mesh_nodes(const GltfDocument& document) {
  const std::optional<JsonView> nodes = document.root().find("nodes");
  std::vector<GltfMeshNode> found;
  if (!nodes) return found;
  std::vector<bool> seen(nodes->size());
  // An explicit stack, since a chain of nodes may be as long as the file.
  std::vector<Pending> stack = first_nodes(document, *nodes);
  std::reverse(stack.begin(), stack.end());
  while (!stack.empty()) {
    const Pending next = std::move(stack.back());
    stack.pop_back();
    const JsonView node = nodes->at(next.node);
    if (seen[next.node])
      JsonView(node.json(), document.file(), next.place)
          .fail("refers to " + node.place() + ", which has another parent", "the nodes of a scene have to form a tree");
    seen[next.node] = true;
    const Affine3d map = next.parent * map_of(node);
    if (node.find("mesh")) found.push_back({next.node, map});
    const std::optional<JsonView> children = node.find("children");
    for (std::size_t i = children ? children->size() : 0; i-- > 0;) {
      (void)document.item("nodes", children->at(i));
      stack.push_back({static_cast<std::size_t>(children->at(i).integer()), map, children->at(i).place()});
    }
  }
  return found;
}

std::vector<Affine3d> instances_of(GltfDocument& document, const JsonView& node) {
  const std::optional<JsonView> instancing = extension(node, "EXT_mesh_gpu_instancing");
  if (!instancing) return {Affine3d{}};
  const JsonView attributes = instancing->at("attributes");
  std::optional<std::size_t> count;
  const auto read = [&](const char* name, int components) {
    const std::optional<JsonView> reference = attributes.find(name);
    if (!reference) return std::vector<double>{};
    const GltfAccessor accessor = open_accessor(document, *reference);
    if (accessor.components != components || (count && *count != accessor.count))
      reference->fail("does not match the other attributes of the instances", damaged_file);
    count = accessor.count;
    return read_values(accessor, components);
  };
  const std::vector<double> t = read("TRANSLATION", 3), r = read("ROTATION", 4), s = read("SCALE", 3);
  std::vector<Affine3d> maps;
  for (std::size_t k = 0; k < count.value_or(0); ++k) {
    Placement place;
    if (!t.empty()) std::copy_n(&t[3 * k], 3, place.translation.begin());
    if (!r.empty()) std::copy_n(&r[4 * k], 4, place.rotation.begin());
    if (!s.empty()) std::copy_n(&s[3 * k], 3, place.scale.begin());
    maps.push_back(place.map(*instancing));
  }
  return maps;
}

}  // namespace lodestone
