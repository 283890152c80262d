// Small hierarchies made the slow, obvious way: an independent twin of the builder for tests of selection, morph and
// backends.
//
// P maps each vertex to the first vertex of its cluster, a cubic grid so fine that constraint (1) holds; then every
// stored quantity is read off its definition. No blocks, no queues, no packing.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <vector>

#include "core/hierarchy/model/fingerprint.h"
#include "core/hierarchy/model/hierarchy.h"

namespace lodestone::test {

// A hierarchy and what it was made of: `ancestors[l][v]` is the vertex of the mesh that v has become at level l.
struct SmallHierarchy {
  IndexedMesh mesh;
  std::vector<std::vector<std::uint32_t>> ancestors;
  Hierarchy hierarchy;
};

namespace detail {

struct CellData {
  std::vector<std::uint32_t> vertices;  // ids in the mesh; those of several cells last
  std::map<std::uint32_t, std::uint32_t> local;
  std::vector<Vec3f> positions;
  std::vector<PackedNormal> normals;
  std::vector<std::uint32_t> parents, shared;
  std::vector<Triangle> triangles;
};
using LevelData = std::map<std::uint64_t, CellData>;  // by Morton code

inline float rounded_up(double v) {
  return std::nextafter(static_cast<float>(v), std::numeric_limits<float>::infinity());
}

// P of level l as a map of vertices that stays within sigma0 h_l / 2: clusters of that diagonal, the lowest id leads.
inline std::vector<std::uint32_t> cluster(const IndexedMesh& mesh, const std::vector<std::uint32_t>& present,
                                          float sigma0, int level) {
  const double side = 0.999 * displacement_bound(sigma0, level) / std::sqrt(3.0);
  const auto slot = [&](std::uint32_t v) {
    const auto along = [side](float c) { return static_cast<long>(std::floor(c / side)); };
    const Vec3f p = mesh.positions[v];
    return std::tuple(along(p.x), along(p.y), along(p.z));
  };
  std::map<std::tuple<long, long, long>, std::uint32_t> leader;
  for (const std::uint32_t v : present) {
    const auto [entry, added] = leader.try_emplace(slot(v), v);
    if (!added) entry->second = std::min(entry->second, v);
  }
  std::vector<std::uint32_t> parent;
  for (const std::uint32_t v : present) parent.push_back(leader.at(slot(v)));
  return parent;
}

inline std::vector<PackedNormal> vertex_normals(const IndexedMesh& mesh, const std::vector<std::uint32_t>& at) {
  std::vector<Vec3f> sums(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3f a = mesh.positions[at[t.v[0]]], b = mesh.positions[at[t.v[1]]], c = mesh.positions[at[t.v[2]]];
    for (const std::uint32_t v : t.v) sums[at[v]] = sums[at[v]] + cross(b - a, c - a);
  }
  std::vector<PackedNormal> packed;
  for (const Vec3f n : sums) packed.push_back(pack_normal(1e6f * n));
  return packed;
}

// The cells of level l: the vertices of a cell are the images of all the triangles below it.
inline LevelData cells_of_level(const IndexedMesh& mesh, const std::vector<std::uint32_t>& at, int level, int finest) {
  const auto code_of = [&](const Triangle& t) {
    const Vec3f middle = barycentre(mesh.positions[t.v[0]], mesh.positions[t.v[1]], mesh.positions[t.v[2]]);
    return CellCode::from(cell_of(middle, finest)).morton >> (3 * (finest - level));
  };
  std::map<std::uint64_t, std::set<std::uint32_t>> used;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t.v) used[code_of(t)].insert(at[v]);
  std::map<std::uint32_t, int> cells_using;
  for (const auto& [code, vertices] : used)
    for (const std::uint32_t v : vertices) ++cells_using[v];

  LevelData cells;
  const std::vector<PackedNormal> normals = vertex_normals(mesh, at);
  for (const auto& [code, vertices] : used) {
    CellData& data = cells[code];
    data.vertices.assign(vertices.begin(), vertices.end());
    std::stable_partition(data.vertices.begin(), data.vertices.end(),
                          [&](std::uint32_t v) { return cells_using[v] == 1; });
    for (const std::uint32_t v : data.vertices) {
      data.local[v] = static_cast<std::uint32_t>(data.positions.size());
      data.positions.push_back(mesh.positions[v]);
      data.normals.push_back(normals[v]);
      if (cells_using[v] > 1) data.shared.push_back(v);
    }
  }
  for (const Triangle& t : mesh.triangles) {
    CellData& data = cells[code_of(t)];
    const Triangle image{{data.local.at(at[t.v[0]]), data.local.at(at[t.v[1]]), data.local.at(at[t.v[2]])}};
    if (!is_degenerate(image)) data.triangles.push_back(image);
  }
  return cells;
}

// Appends the cells of a level to the table and links them with their parents.
inline void append_level(Hierarchy& h, int l, const LevelData& cells) {
  Level& level = h.levels[static_cast<std::size_t>(l)];
  level.first_cell = static_cast<std::uint32_t>(h.cells.size());
  for (const auto& [code, data] : cells) {
    Cell cell;
    cell.code = {code};
    cell.positions = data.positions;
    cell.normals = data.normals;
    cell.parents = data.parents;
    cell.shared_ids = data.shared;
    cell.triangles = data.triangles;
    for (const Vec3f p : data.positions) cell.bounds.extend(p);
    // Sum of the displacement bounds of the finer levels.
    if (l < h.finest()) cell.error = h.sigma0 * cell_size(l) / 2;
    if (l > 0) {
      const Level& coarser = h.levels[static_cast<std::size_t>(l - 1)];
      cell.parent = coarser.first_cell;
      while (h.cells[cell.parent].code != cell.code.parent()) ++cell.parent;
      Cell& parent = h.cells[cell.parent];
      if (parent.child_count++ == 0) parent.first_child = static_cast<std::uint32_t>(h.cells.size());
      for (std::size_t i = 0; i < data.positions.size(); ++i)
        cell.max_displacement = std::max(cell.max_displacement, distance(DistanceMetric::euclidean, data.positions[i],
                                                                         parent.positions[data.parents[i]]));
    }
    level.triangles += data.triangles.size();
    level.vertices += data.positions.size();
    h.cells.push_back(cell);
  }
  level.cell_count = static_cast<std::uint32_t>(h.cells.size()) - level.first_cell;
}

// Reach, diameter, error and edges of a level, over h_l; the bounds must be nested already.
inline void measure_level(Hierarchy& h, int l) {
  Level& level = h.levels[static_cast<std::size_t>(l)];
  const auto raise = [side = double{cell_size(l)}](float& value, float measured) {
    value = std::max(value, rounded_up(double{measured} / side));
  };
  for (const Cell& cell : h.cells_of(l)) {
    for (const DistanceMetric metric : {DistanceMetric::euclidean, DistanceMetric::chebyshev})
      for (const Vec3f p : cell.positions)
        raise(level.reach[static_cast<std::size_t>(metric)], farthest_corner_distance(metric, p, cell.bounds));
    raise(level.diameter, length(cell.bounds.hi - cell.bounds.lo));
    raise(level.error, cell.error);
    for (const Triangle& t : cell.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const float edge = length(cell.positions[t.v[k]] - cell.positions[t.v[(k + 1) % 3]]);
        raise(level.max_edge, edge);
        if (edge > h.sigma0 * cell_size(l)) ++level.long_edges;
      }
  }
}

}  // namespace detail

// Finest level L >= 0. Every field of the hierarchy is set.
inline SmallHierarchy small_hierarchy(IndexedMesh mesh, int finest, float sigma0 = 0.5f) {
  const auto levels = static_cast<std::size_t>(finest) + 1;
  SmallHierarchy small;
  small.ancestors.resize(levels);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) small.ancestors.back().push_back(v);
  for (std::size_t l = levels - 1; l >= 1; --l)
    small.ancestors[l - 1] = detail::cluster(mesh, small.ancestors[l], sigma0, static_cast<int>(l));

  Hierarchy& h = small.hierarchy;
  h.transform = mesh.transform;
  h.sigma0 = sigma0;
  h.levels.resize(levels);
  const auto storage = std::make_shared<std::vector<detail::LevelData>>();
  storage->reserve(levels);
  for (std::size_t l = 0; l < levels; ++l) {
    storage->push_back(detail::cells_of_level(mesh, small.ancestors[l], static_cast<int>(l), finest));
    for (auto& [code, data] : storage->back())
      for (const std::uint32_t v : data.vertices)
        if (l > 0) {
          // A leader leads itself at all finer levels, so v is one of them.
          const std::uint32_t up = small.ancestors[l - 1][v];
          data.parents.push_back((*storage)[l - 1].at(code >> 3).local.at(up));
        }
    detail::append_level(h, static_cast<int>(l), storage->back());
  }
  for (std::size_t k = h.cells.size(); k-- > 1;) h.cells[h.cells[k].parent].bounds.extend(h.cells[k].bounds);
  for (int l = 0; l <= finest; ++l) detail::measure_level(h, l);

  for (const Triangle& t : mesh.triangles)
    h.provenance.fingerprint +=
        triangle_fingerprint(mesh.positions[t.v[0]], mesh.positions[t.v[1]], mesh.positions[t.v[2]]);
  h.provenance.input_vertices = mesh.positions.size();
  h.provenance.input_triangles = mesh.triangles.size();
  h.storage = storage;
  small.mesh = std::move(mesh);
  return small;
}

}  // namespace lodestone::test
