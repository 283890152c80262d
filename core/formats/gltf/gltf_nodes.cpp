#include "core/formats/gltf/gltf_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lodestone {
namespace {

// Columns of the rotation by a quaternion (x, y, z, w), whatever its length.
std::array<Vec3d, 3> rotation_axes(const JsonView& node, const std::array<double, 4>& q) {
  const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(square > 0) || !std::isfinite(square)) node.fail("a rotation that is none");
  const double x = q[0], y = q[1], z = q[2], w = q[3], s = 2 / square;
  return {Vec3d{1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)},
          Vec3d{s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)},
          Vec3d{s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)}};
}

Affine3d map_of(const JsonView& node) {
  if (const std::optional<JsonView> matrix = node.find("matrix")) return affine_of(*matrix);
  const auto t = node.numbers_or<3>("translation", {0, 0, 0});
  const auto s = node.numbers_or<3>("scale", {1, 1, 1});
  Affine3d map{rotation_axes(node, node.numbers_or<4>("rotation", {0, 0, 0, 1})), {t[0], t[1], t[2]}};
  for (std::size_t i = 0; i < 3; ++i) map.axes[i] = s[i] * map.axes[i];
  return map;
}

// Where the walk begins: values that hold the indices of nodes.
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

// A node that waits for its turn.
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

Affine3d affine_of(const JsonView& matrix) {
  const std::array<double, 16> m = matrix.numbers<16>();
  if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) matrix.fail("a matrix whose last row is not (0, 0, 0, 1)");
  return {{Vec3d{m[0], m[1], m[2]}, Vec3d{m[4], m[5], m[6]}, Vec3d{m[8], m[9], m[10]}}, {m[12], m[13], m[14]}};
}

std::vector<GltfMeshNode> list_mesh_nodes(const GltfDocument& document) {
  const std::optional<JsonView> nodes = document.root().find("nodes");
  std::vector<GltfMeshNode> found;
  if (!nodes) return found;
  std::vector<bool> seen(nodes->size());
  // A stack of our own: a chain of nodes may be as long as the file.
  std::vector<Pending> stack = first_nodes(document, *nodes);
  std::reverse(stack.begin(), stack.end());
  while (!stack.empty()) {
    const Pending next = std::move(stack.back());
    stack.pop_back();
    const JsonView node = nodes->at(next.node);
    if (seen[next.node])
      JsonView(node.json(), document.file(), next.place)
          .fail("a second way to " + node.place(), "the nodes of a scene have to form a tree");
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

}  // namespace lodestone
