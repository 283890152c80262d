#include "core/progressive/mesh/level.h"

#include <algorithm>

#include "core/progressive/mesh/activation.h"
#include "core/progressive/mesh/flaps.h"
#include "core/progressive/mesh/placement.h"

namespace lodestone {

LevelFinder::LevelFinder(const ProgressiveMesh& mesh) : mesh_(&mesh), groups_(progressive::group_starts(mesh)) {
  activations_.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) activations_.push_back(progressive::activation_of(t, mesh, groups_));
  progressive::delay_flaps(mesh, groups_, mesh.triangles, activations_);
}

std::uint32_t LevelFinder::vertices_for(std::uint32_t most) const {
  if (most >= mesh_->vertex_count()) return mesh_->vertex_count();
  return std::max(groups_[most], mesh_->base_vertices);
}

// The triangle after the last one allowed comes in with its vertex, which must therefore be left out.
std::uint32_t LevelFinder::vertices_for_triangles(std::size_t most) const {
  if (most >= triangles_of(mesh_->vertex_count())) return mesh_->vertex_count();
  return std::max(activations_[most], mesh_->base_vertices);
}

std::uint32_t LevelFinder::vertices_for_error(float error) const {
  const auto& errors = mesh_->errors;
  const auto at = std::partition_point(errors.begin(), errors.end(), [&](float e) { return e > error; });
  const auto missing = static_cast<std::uint32_t>(at - errors.begin());
  return missing >= errors.size() ? mesh_->vertex_count() : std::max(missing, mesh_->base_vertices);
}

std::size_t LevelFinder::triangles_of(std::uint32_t vertices) const {
  return static_cast<std::size_t>(std::lower_bound(activations_.begin(), activations_.end(), vertices) -
                                  activations_.begin());
}

float LevelFinder::error_of(std::uint32_t vertices) const {
  return vertices < mesh_->vertex_count() ? mesh_->errors[vertices] : 0;
}

std::vector<Triangle> LevelFinder::compute_level(std::uint32_t vertices) const {
  const auto count = static_cast<std::ptrdiff_t>(triangles_of(vertices));
  std::vector<Triangle> out(mesh_->triangles.begin(), mesh_->triangles.begin() + count);
  if (vertices >= mesh_->vertex_count()) return out;
  const std::vector<std::uint32_t> ancestor = compute_geomorph(vertices, mesh_->vertex_count());
  for (Triangle& t : out) t = {ancestor[t.v[0]], ancestor[t.v[1]], ancestor[t.v[2]]};
  return out;
}

PlacedLevel LevelFinder::placed_level(std::uint32_t vertices) const {
  PlacedLevel level{{}, compute_level(vertices)};
  if (vertices >= mesh_->vertex_count()) {
    level.positions = mesh_->positions;
    return level;
  }
  const std::vector<std::uint32_t> ancestors = compute_geomorph(vertices, mesh_->vertex_count());
  level.positions = progressive::place_level(*mesh_, {groups_, ancestors, level.triangles, vertices});
  return level;
}

RawMesh LevelFinder::level_mesh(std::uint32_t vertices) const {
  RawMesh raw;
  raw.up = mesh_->transform.up;
  const auto prefix = [&](const auto& values) {
    const std::size_t count = std::min<std::size_t>(values.size(), vertices);
    return std::vector(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
  };
  PlacedLevel level = placed_level(vertices);
  raw.triangles = std::move(level.triangles);
  for (const Vec3f p : level.positions) raw.positions.push_back(mesh_->transform.to_model(p));
  raw.wedges.uv = prefix(mesh_->wedges.uv);
  raw.wedges.normal = prefix(mesh_->wedges.normal);
  raw.wedges.colour = prefix(mesh_->wedges.colour);
  raw.materials = mesh_->wedges.materials;
  raw.textures = mesh_->wedges.textures;
  if (!raw.materials.empty())
    for (const Triangle& t : raw.triangles)
      raw.wedges.material.push_back(mesh_->wedges.material.empty() ? 0 : mesh_->wedges.material[t.v[0]]);
  return raw;
}

std::vector<std::uint32_t> LevelFinder::compute_geomorph(std::uint32_t coarse, std::uint32_t fine) const {
  std::vector<std::uint32_t> ancestor(fine);
  for (std::uint32_t v = 0; v < std::min(coarse, fine); ++v) ancestor[v] = v;
  for (std::uint32_t v = coarse; v < fine; ++v) ancestor[v] = ancestor[mesh_->parents[v]];
  return ancestor;
}

}  // namespace lodestone
