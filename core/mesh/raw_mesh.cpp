#include "core/mesh/raw_mesh.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "core/base/error.h"

namespace lodestone {
namespace {

template <class T>
void append(std::vector<T>& items, std::vector<T>&& more) {
  items.insert(items.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  std::vector<T>().swap(more);
}

// `items` has `count` values or none, `more` has `more_count` or none; absent ones count as `absent`.
template <class T>
void append_values(std::vector<T>& items, std::size_t count, std::vector<T>&& more, std::size_t more_count, T absent) {
  if (items.empty() && more.empty()) return;
  items.resize(count, absent);
  more.resize(more_count, absent);
  append(items, std::move(more));
}

std::vector<Triangle> moved(std::vector<Triangle>&& triangles, std::size_t by) {
  for (Triangle& t : triangles)
    for (std::uint32_t& id : t.v) id += static_cast<std::uint32_t>(by);
  return std::move(triangles);
}

// Adds the items of `more` that `items` lacks and returns the index of each: tiles of a set share materials and images.
template <class T>
std::vector<std::uint32_t> merge(std::vector<T>& items, std::vector<T>&& more) {
  std::vector<std::uint32_t> places;
  for (T& item : more) {
    const auto found = std::find(items.begin(), items.end(), item);
    places.push_back(static_cast<std::uint32_t>(found - items.begin()));
    if (found == items.end()) items.push_back(std::move(item));
  }
  std::vector<T>().swap(more);
  return places;
}

void append_materials(RawMesh& mesh, RawMesh& part) {
  const std::vector<std::uint32_t> textures = merge(mesh.textures, std::move(part.textures));
  for (Material& material : part.materials)
    for_each_texture(material, [&](std::uint32_t& texture) {
      if (texture != no_texture) texture = textures[texture];
    });
  const std::vector<std::uint32_t> materials = merge(mesh.materials, std::move(part.materials));
  if (!materials.empty())
    for (std::uint32_t& material : part.wedges.material)
      if (material != no_material) material = materials[material];
  append_values(mesh.wedges.material, mesh.triangles.size(), std::move(part.wedges.material), part.triangles.size(),
                no_material);
}

void append_wedges(RawMesh& mesh, RawMesh& part) {
  if (mesh.wedges.empty() && part.wedges.empty()) return;
  // The side without wedges gets one per vertex, like a side whose wedges are its vertices.
  const auto wedges_of = [](const RawMesh& m) { return m.wedges.empty() ? m.positions.size() : wedge_count(m); };
  const std::size_t count = wedges_of(mesh), more = wedges_of(part);
  RawWedges &a = mesh.wedges, &b = part.wedges;
  if (!a.corners.empty() || !b.corners.empty()) {
    if (a.corners.empty()) a.corners = mesh.triangles;
    if (b.corners.empty()) b.corners = part.triangles;
    append(a.corners, moved(std::move(b.corners), count));
  }
  append_values(a.uv, count, std::move(b.uv), more, Vec2f{});
  append_values(a.normal, count, std::move(b.normal), more, Vec3f{});
  append_values(a.colour, count, std::move(b.colour), more, Rgba8{});
}

}  // namespace

void append_mesh(RawMesh& mesh, RawMesh&& part, const std::string& name) {
  constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max();
  if (mesh.positions.size() + part.positions.size() > most || wedge_count(mesh) + wedge_count(part) > most)
    throw ResourceError(describe(name, "", "more vertices than 32-bit indices reach", "split the model"));
  append_materials(mesh, part);
  append_wedges(mesh, part);
  append(mesh.triangles, moved(std::move(part.triangles), mesh.positions.size()));
  append(mesh.positions, std::move(part.positions));
  append(mesh.warnings, std::move(part.warnings));
  mesh.polygons_triangulated += part.polygons_triangulated;
  mesh.faces_dropped += part.faces_dropped;
  mesh.void_posts += part.void_posts;
  mesh.filled_posts += part.filled_posts;
}

Box3d finite_box(std::span<const Vec3d> positions) {
  Box3d box;
  for (const Vec3d p : positions)
    if (is_finite(p)) box.extend(p);
  return box;
}

void transform_mesh(RawMesh& mesh, const Affine3d& map) {
  if (map == Affine3d{}) return;
  for (Vec3d& position : mesh.positions) position = map.point(position);
  for (Vec3f& normal : mesh.wedges.normal) normal = unit_normal(map.normal(to_double(normal)));
  if (map.determinant() >= 0) return;
  for (auto* triangles : {&mesh.triangles, &mesh.wedges.corners})
    for (Triangle& t : *triangles) std::swap(t.v[1], t.v[2]);
}

RawMesh in_model_space(const IndexedMesh& mesh) {
  RawMesh raw;
  raw.up = mesh.transform.up;
  raw.positions.reserve(mesh.positions.size());
  for (const Vec3f& p : mesh.positions) raw.positions.push_back(mesh.transform.to_model(p));
  raw.triangles = mesh.triangles;
  return raw;
}

Vec3f unit_normal(Vec3d direction) {
  const double size = length(direction);
  if (!(size > 0) || !std::isfinite(size)) return {};
  return to_float((1 / size) * direction);
}

}  // namespace lodestone
