// The slow, obvious builder: one by one the definitions of docs/architecture.md, with maps and sets over the
// whole level. The twin of build_hierarchy for tests; its simplifier clusters the vertices of a level on a grid whose
// half diagonal is the bound of (1).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <vector>

#include "core/hierarchy/model/fingerprint.h"
#include "core/hierarchy/model/hierarchy.h"

namespace lodestone::testing {

struct NaiveCell {
  std::set<std::uint32_t> vertices;  // V_l(C), by global id
  std::vector<Triangle> triangles;   // by global id
};

struct NaiveLevel {
  std::map<std::uint32_t, Vec3f> positions;        // by global id
  std::map<std::uint32_t, std::uint32_t> parents;  // P: ids of this level to ids of the next coarser one
  std::map<std::uint64_t, NaiveCell> cells;        // by Morton code
};

// What a Cell's spans look at; public, so that a test can break it.
struct NaivePayload {
  std::vector<Vec3f> positions;
  std::vector<PackedNormal> normals;
  std::vector<std::uint32_t> parents, shared_ids;
  std::vector<Triangle> triangles;
};

struct NaiveHierarchy {
  Hierarchy hierarchy;
  std::shared_ptr<std::vector<NaivePayload>> payloads;  // one per cell

  // Points the spans at the payloads again, after one of them was altered.
  void attach() {
    for (std::size_t i = 0; i < payloads->size(); ++i) {
      const NaivePayload& p = (*payloads)[i];
      Cell& c = hierarchy.cells[i];
      c.positions = p.positions;
      c.normals = p.normals;
      c.parents = p.parents;
      c.shared_ids = p.shared_ids;
      c.triangles = p.triangles;
    }
  }
};

inline NaiveLevel naive_finest(const IndexedMesh& mesh, int finest) {
  NaiveLevel level;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) level.positions[v] = mesh.positions[v];
  for (const Triangle& t : mesh.triangles) {
    const Vec3f centre = barycentre(mesh.positions[t.v[0]], mesh.positions[t.v[1]], mesh.positions[t.v[2]]);
    NaiveCell& cell = level.cells[CellCode::from(cell_of(centre, finest)).morton];
    cell.triangles.push_back(t);
    cell.vertices.insert(t.v.begin(), t.v.end());
  }
  return level;
}

// P of a whole level: the vertices in a cube of a grid become one, with the lowest id among them, at the cube's centre.
// So nearly every vertex moves at every level, some by all that (1) allows.
inline void naive_simplify(NaiveLevel& fine, NaiveLevel& coarse, double max_displacement) {
  const double side = 0.999 * 2 * max_displacement / std::sqrt(3.0);
  std::map<std::tuple<long, long, long>, std::uint32_t> clusters;
  for (const auto& [id, p] : fine.positions) {
    const auto slot = [&](float x) { return std::lround(std::floor(x / side)); };
    const auto centre = [&](float x) { return (static_cast<double>(slot(x)) + 0.5) * side; };
    const auto [cluster, is_new] = clusters.try_emplace({slot(p.x), slot(p.y), slot(p.z)}, id);
    if (is_new) coarse.positions[id] = to_float(Vec3d{centre(p.x), centre(p.y), centre(p.z)});
    fine.parents[id] = cluster->second;
  }
}

inline NaiveLevel naive_coarser(NaiveLevel& fine, double max_displacement) {
  NaiveLevel coarse;
  naive_simplify(fine, coarse, max_displacement);
  for (const auto& [code, cell] : fine.cells) {
    NaiveCell& parent = coarse.cells[code >> 3];
    for (const std::uint32_t id : cell.vertices) parent.vertices.insert(fine.parents[id]);
    for (const Triangle& t : cell.triangles) {
      const Triangle image{{fine.parents[t.v[0]], fine.parents[t.v[1]], fine.parents[t.v[2]]}};
      if (!is_degenerate(image)) parent.triangles.push_back(image);
    }
  }
  return coarse;
}

// Local index of every vertex of the cell: those of one cell alone first, then the shared ones, by id.
inline std::map<std::uint32_t, std::uint32_t> naive_local_ids(const NaiveCell& cell,
                                                              const std::map<std::uint32_t, int>& users) {
  std::map<std::uint32_t, std::uint32_t> local;
  for (const bool shared : {false, true})
    for (const std::uint32_t id : cell.vertices)
      if ((users.at(id) > 1) == shared) local.try_emplace(id, static_cast<std::uint32_t>(local.size()));
  return local;
}

inline std::map<std::uint32_t, int> naive_users(const NaiveLevel& level) {
  std::map<std::uint32_t, int> users;
  for (const auto& [code, cell] : level.cells)
    for (const std::uint32_t id : cell.vertices) ++users[id];
  return users;
}

inline std::map<std::uint32_t, Vec3f> naive_normals(const NaiveLevel& level) {
  std::map<std::uint32_t, Vec3f> sums;
  for (const auto& [code, cell] : level.cells)
    for (const Triangle& t : cell.triangles) {
      const Vec3f a = level.positions.at(t.v[0]);
      const Vec3f n = cross(level.positions.at(t.v[1]) - a, level.positions.at(t.v[2]) - a);
      for (const std::uint32_t id : t.v) sums[id] = sums[id] + n;
    }
  return sums;
}

class NaiveBuilder {
 public:
  NaiveBuilder(const IndexedMesh& mesh, int finest, float sigma0) {
    out_.hierarchy.sigma0 = sigma0;
    out_.hierarchy.transform = mesh.transform;
    out_.hierarchy.provenance.input_vertices = mesh.positions.size();
    out_.hierarchy.provenance.input_triangles = mesh.triangles.size();
    for (const Triangle& t : mesh.triangles)
      out_.hierarchy.provenance.fingerprint +=
          triangle_fingerprint(mesh.positions[t.v[0]], mesh.positions[t.v[1]], mesh.positions[t.v[2]]);
    levels_.resize(static_cast<std::size_t>(finest) + 1);
    levels_.back() = naive_finest(mesh, finest);
    for (std::size_t l = levels_.size() - 1; l > 0; --l)
      levels_[l - 1] = naive_coarser(levels_[l], displacement_bound(sigma0, static_cast<int>(l)));
  }

  NaiveHierarchy build() {
    out_.payloads = std::make_shared<std::vector<NaivePayload>>();
    for (std::size_t l = 0; l < levels_.size(); ++l) add_level(l);
    out_.attach();
    link_cells();
    measure();
    out_.hierarchy.storage = out_.payloads;
    return std::move(out_);
  }

 private:
  void add_level(std::size_t l) {
    const NaiveLevel& level = levels_[l];
    const auto users = naive_users(level);
    const auto normals = naive_normals(level);
    const auto coarser_users = l > 0 ? naive_users(levels_[l - 1]) : std::map<std::uint32_t, int>{};
    Level& out = out_.hierarchy.levels.emplace_back();
    out.first_cell = static_cast<std::uint32_t>(out_.hierarchy.cells.size());
    out.cell_count = static_cast<std::uint32_t>(level.cells.size());
    for (const auto& [code, cell] : level.cells) {
      const auto local = naive_local_ids(cell, users);
      NaivePayload& payload = out_.payloads->emplace_back();
      payload.positions.resize(local.size());
      payload.normals.resize(local.size());
      for (const auto& [id, i] : local) {
        payload.positions[i] = level.positions.at(id);
        payload.normals[i] = pack_normal(normals.contains(id) ? normals.at(id) : Vec3f{});
        if (users.at(id) > 1) payload.shared_ids.push_back(id);  // maps iterate by id: the same order as the indices
      }
      if (l > 0) {
        const auto coarser = naive_local_ids(levels_[l - 1].cells.at(code >> 3), coarser_users);
        payload.parents.resize(local.size());
        for (const auto& [id, i] : local) payload.parents[i] = coarser.at(level.parents.at(id));
      }
      for (const Triangle& t : cell.triangles)
        payload.triangles.push_back({{local.at(t.v[0]), local.at(t.v[1]), local.at(t.v[2])}});
      out_.hierarchy.cells.emplace_back().code = {code};
      out.triangles += payload.triangles.size();
      out.vertices += payload.positions.size();
    }
  }

  void link_cells() {
    Hierarchy& h = out_.hierarchy;
    for (std::size_t l = 1; l < h.levels.size(); ++l)
      for (std::uint32_t i = h.levels[l].first_cell; i < h.levels[l].first_cell + h.levels[l].cell_count; ++i)
        for (std::uint32_t p = h.levels[l - 1].first_cell; p < h.levels[l].first_cell; ++p) {
          if (h.cells[p].code != h.cells[i].code.parent()) continue;
          h.cells[i].parent = p;
          if (h.cells[p].child_count++ == 0) h.cells[p].first_child = i;
        }
  }

  static constexpr float up = 1e9f;
  static float rounded_up(double v) { return v > 0 ? std::nextafter(static_cast<float>(v), up) : 0.0f; }

  // Bounds, displacements, errors (the sum of the displacements bounds the distance), then the figures of the levels.
  void measure() {
    Hierarchy& h = out_.hierarchy;
    for (std::size_t i = h.cells.size(); i-- > 0;) {
      Cell& cell = h.cells[i];
      for (const Vec3f p : cell.positions) cell.bounds.extend(p);
      for (std::uint32_t k = 0; k < cell.child_count; ++k) {
        const Cell& child = h.cells[cell.first_child + k];
        cell.bounds.extend(child.bounds);
        cell.error = std::max(cell.error, std::nextafter(child.error + child.max_displacement, up));
      }
      for (std::size_t v = 0; v < cell.parents.size(); ++v)
        cell.max_displacement = std::max(
            cell.max_displacement, rounded_up(length(to_double(cell.positions[v]) -
                                                     to_double(h.cells[cell.parent].positions[cell.parents[v]]))));
    }
    for (int l = 0; l <= h.finest(); ++l) {
      Level& level = h.levels[static_cast<std::size_t>(l)];
      const float size = cell_size(l);
      for (const Cell& cell : h.cells_of(l)) {
        for (int m = 0; m < distance_metric_count; ++m)
          for (const Vec3f p : cell.positions)
            level.reach[static_cast<std::size_t>(m)] = std::max(
                level.reach[static_cast<std::size_t>(m)],
                std::nextafter(farthest_corner_distance(static_cast<DistanceMetric>(m), p, cell.bounds) / size, up));
        level.diameter = std::max(level.diameter, std::nextafter(length(cell.bounds.hi - cell.bounds.lo) / size, up));
        level.error = std::max(level.error, std::nextafter(cell.error / size, up));
        for (const Triangle& t : cell.triangles)
          for (std::size_t k = 0; k < 3; ++k) {
            const float edge = length(cell.positions[t.v[k]] - cell.positions[t.v[(k + 1) % 3]]);
            level.max_edge = std::max(level.max_edge, std::nextafter(edge / size, up));
            level.long_edges += edge > h.sigma0 * size;
          }
      }
    }
  }

  std::vector<NaiveLevel> levels_;
  NaiveHierarchy out_;
};

inline NaiveHierarchy naive_hierarchy(const IndexedMesh& mesh, int finest, float sigma0) {
  return NaiveBuilder(mesh, finest, sigma0).build();
}

}  // namespace lodestone::testing
