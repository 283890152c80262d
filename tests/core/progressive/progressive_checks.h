// The promises of a progressive mesh, checked without the code that makes or reads them: slow and obvious.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/math/vec3.h"
#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone::test {

// Vertices of equal position that stand together, by following definitions: wedges of one vertex.
inline std::vector<std::uint32_t> obvious_groups(const ProgressiveMesh& mesh) {
  std::vector<std::uint32_t> group(mesh.positions.size());
  for (std::uint32_t v = 0; v < group.size(); ++v) {
    group[v] = v;
    if (v == 0 || v == mesh.base_vertices || !(mesh.positions[v] == mesh.positions[v - 1])) continue;
    if (v < mesh.base_vertices || group[mesh.parents[v]] == group[mesh.parents[v - 1]]) group[v] = group[v - 1];
  }
  return group;
}

inline std::uint32_t obvious_ancestor(const ProgressiveMesh& mesh, std::uint32_t v, std::uint32_t count) {
  while (v >= count) v = mesh.parents[v];
  return v;
}

// By vertex: how far the flap that it is on may reach, as core/progressive/mesh/flaps.h has it; 0 if it is on none.
inline std::vector<double> obvious_flaps(const ProgressiveMesh& mesh) {
  const std::vector<std::uint32_t> group = obvious_groups(mesh);
  std::vector<std::uint32_t> part = group;
  for (bool changed = true; changed;) {
    changed = false;
    for (const Triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t &a = part[group[t.v[k]]], &b = part[group[t.v[(k + 1) % 3]]];
        changed = changed || a != b;
        a = b = std::min(a, b);
      }
  }
  for (std::uint32_t v = 0; v < part.size(); ++v) part[v] = part[group[v]];
  std::set<std::uint32_t> collapsing;
  for (std::uint32_t v = mesh.base_vertices; v < part.size(); ++v) {
    collapsing.insert(part[v]);
    collapsing.insert(part[obvious_ancestor(mesh, v, mesh.base_vertices)]);
  }
  using Key = std::tuple<float, float, float>;
  const auto key = [&](std::uint32_t v) { return Key(mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z); };
  std::set<Key> others;
  for (std::uint32_t v = 0; v < part.size(); ++v)
    if (collapsing.contains(part[v])) others.insert(key(v));
  std::map<std::uint32_t, Box3f> flaps;
  std::set<std::uint32_t> touching, loose;
  for (std::uint32_t v = 0; v < part.size(); ++v)
    if (!collapsing.contains(part[v])) flaps[part[v]].extend(mesh.positions[v]);
  for (std::uint32_t v = 0; v < part.size(); ++v) (others.contains(key(v)) ? touching : loose).insert(part[v]);
  std::vector<double> extents(part.size(), 0);
  for (std::uint32_t v = 0; v < part.size(); ++v)
    if (const auto at = flaps.find(part[v]); at != flaps.end() && touching.contains(part[v]))
      extents[v] = (loose.contains(part[v]) ? 1 : 0.5) * length(to_double(at->second.hi) - to_double(at->second.lo));
  return extents;
}

// A level as it is defined, in the order of the triangles of the mesh.
inline std::vector<Triangle> obvious_level(const ProgressiveMesh& mesh, std::uint32_t count) {
  const std::vector<std::uint32_t> group = obvious_groups(mesh);
  const std::vector<double> flaps = obvious_flaps(mesh);
  std::vector<Triangle> out;
  for (const Triangle& t : mesh.triangles) {
    if (count < mesh.vertex_count() && flaps[t.v[0]] > 0 && mesh.errors[count] >= flaps[t.v[0]]) continue;
    Triangle image, ends;
    for (std::size_t k = 0; k < 3; ++k) {
      image.v[k] = obvious_ancestor(mesh, t.v[k], count);
      ends.v[k] = group[image.v[k]];
    }
    if (!is_degenerate(ends)) out.push_back(image);
  }
  return out;
}

// Half-edges of a level that are not paired, between groups: none when it is closed.
inline std::size_t open_edges(const ProgressiveMesh& mesh, const std::vector<Triangle>& level) {
  const std::vector<std::uint32_t> group = obvious_groups(mesh);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const Triangle& t : level)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = group[t.v[k]], b = group[t.v[(k + 1) % 3]];
      a < b ? ++balance[{a, b}] : --balance[{b, a}];
    }
  return static_cast<std::size_t>(std::count_if(balance.begin(), balance.end(), [](auto& e) { return e.second != 0; }));
}

// Edges of three triangles or more, or of two that run alike; and triangles that are there twice, turned or not.
inline std::size_t bad_edges(const ProgressiveMesh& mesh, const std::vector<Triangle>& level) {
  const std::vector<std::uint32_t> group = obvious_groups(mesh);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  std::set<std::array<std::uint32_t, 3>> seen;
  std::size_t bad = 0;
  for (const Triangle& t : level) {
    std::array<std::uint32_t, 3> ends{group[t.v[0]], group[t.v[1]], group[t.v[2]]};
    for (std::size_t k = 0; k < 3; ++k) bad += ++uses[{ends[k], ends[(k + 1) % 3]}] > 1 ? 1 : 0;
    std::sort(ends.begin(), ends.end());
    bad += seen.insert(ends).second ? 0 : 1;
  }
  return bad;
}

// A triangle by what its corners are, first the least of them.
using CornerBits = std::array<float, 12>;
template <class Mesh>
std::multiset<std::array<CornerBits, 3>> triangle_values(const Mesh& mesh) {
  const auto corner = [&](std::uint32_t v) {
    const auto& w = mesh.wedges;
    const Vec3f p = mesh.positions[v], n = w.normal.empty() ? Vec3f{} : w.normal[v];
    const Vec2f uv = w.uv.empty() ? Vec2f{} : w.uv[v];
    const Rgba8 c = w.colour.empty() ? Rgba8{} : w.colour[v];
    const auto material = w.material.empty() ? 0.0f : static_cast<float>(w.material[v]);
    return CornerBits{p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y, float(c.r), float(c.g), float(c.b), material};
  };
  std::multiset<std::array<CornerBits, 3>> out;
  for (const Triangle& t : mesh.triangles) {
    std::array<CornerBits, 3> values{corner(t.v[0]), corner(t.v[1]), corner(t.v[2])};
    std::rotate(values.begin(), std::min_element(values.begin(), values.end()), values.end());
    out.insert(values);
  }
  return out;
}

// Describes its fault; empty if there is none.
inline std::string progressive_mistake(const ProgressiveMesh& mesh, const IndexedMesh& input) {
  if (mesh.parents.size() != mesh.positions.size() || mesh.errors.size() != mesh.positions.size()) return "counts";
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (v < mesh.base_vertices ? mesh.parents[v] != 0 : mesh.parents[v] >= v) return "a parent that is not before";
    if (v > 0 && mesh.errors[v] > mesh.errors[v - 1]) return "an error that falls towards the base";
  }
  const std::vector<std::uint32_t> group = obvious_groups(mesh);
  for (std::uint32_t v = mesh.base_vertices; v < mesh.vertex_count(); ++v)
    if (mesh.errors[v] != mesh.errors[group[v]]) return "wedges of one vertex with two errors";
  if (triangle_values(mesh) != triangle_values(input)) return "the finest level is not the input";
  return {};
}

// About `count` levels from the base to the finest, whole groups.
inline std::vector<std::uint32_t> some_levels(const ProgressiveMesh& mesh, std::uint32_t count) {
  const std::vector<std::uint32_t> group = obvious_groups(mesh);
  std::vector<std::uint32_t> levels;
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t v = mesh.base_vertices + (mesh.vertex_count() - mesh.base_vertices) * k / count;
    levels.push_back(v < mesh.vertex_count() ? std::max(group[v], mesh.base_vertices) : v);
  }
  levels.push_back(mesh.vertex_count());
  return levels;
}

}  // namespace lodestone::test
