// Meshes that are nothing but their triangles, as they are given and while they are edited, and checks of their
// borders.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "render/reconstruct/seams/seam_mesh.h"

namespace lodestone::test {

inline IndexedMesh mesh_of(std::vector<Triangle> triangles, std::size_t vertices) {
  IndexedMesh mesh;
  mesh.positions.resize(vertices);
  mesh.triangles = std::move(triangles);
  return mesh;
}

// Two copies that share vertex 0.
inline IndexedMesh touching(IndexedMesh mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.positions.size());
  for (Triangle t : std::vector<Triangle>(mesh.triangles)) {
    for (std::uint32_t& v : t.v) v = v == 0 ? 0 : v + count;
    mesh.triangles.push_back(t);
  }
  mesh.positions.resize(2 * count);
  return mesh;
}

inline std::vector<Triangle> triangles_of(const EditMesh& mesh) {
  std::vector<Triangle> triangles;
  for (TriangleId t{0}; t < mesh.triangle_count(); ++t)
    if (mesh.alive(t)) triangles.push_back(mesh.triangle(t));
  return triangles;
}

// Border edges as the mesh has them.
inline BorderLoops borders_of(const EditMesh& mesh, std::span<const std::uint32_t> piece_of_triangle,
                              std::size_t pieces) {
  BorderLoops borders(mesh.vertex_count());
  std::vector<std::uint32_t> piece;
  std::vector<std::pair<VertexId, VertexId>> edges;
  for (TriangleId t{0}; t < mesh.triangle_count(); ++t)
    for (std::size_t k = 0; mesh.alive(t) && k < 3; ++k) {
      const VertexId a = mesh.corners(t)[k], b = mesh.corners(t)[(k + 1) % 3];
      if (!mesh.is_border(a, b)) continue;
      borders.add_edge(a, b);
      piece.push_back(piece_of_triangle.empty() ? 0 : piece_of_triangle[t]);
      edges.emplace_back(a, b);
    }
  for (BorderEdgeId e{0}; e < edges.size(); ++e)
    borders.link(e, borders.find(edges[e].second, mesh.next_on_border(edges[e].first, edges[e].second)));
  borders.label(piece, pieces);
  return borders;
}

inline void expect_borders_of(const BorderLoops& borders, const EditMesh& mesh) {
  std::map<std::uint32_t, BorderEdgeId> seed_of_loop;
  for (BorderEdgeId e{0}; e < borders.edge_count(); ++e) {
    if (!borders.alive(e)) continue;
    const BorderLoops::Edge& edge = borders.edge(e);
    ASSERT_TRUE(mesh.is_border(edge.from, edge.to));
    ASSERT_EQ(borders.edge(edge.next).from, edge.to);
    ASSERT_EQ(borders.edge(edge.next).to, mesh.next_on_border(edge.from, edge.to));
    ASSERT_EQ(borders.edge(edge.next).previous, e);
    ASSERT_EQ(borders.edge(edge.next).loop, edge.loop);
    seed_of_loop.try_emplace(edge.loop, e);
  }
  // Two loops are two cycles: all edges of a label are met from one of them.
  std::map<std::uint32_t, std::size_t> size, met;
  for (BorderEdgeId e{0}; e < borders.edge_count(); ++e)
    if (borders.alive(e)) ++size[borders.edge(e).loop];
  for (const auto& [loop, seed] : seed_of_loop) {
    BorderEdgeId e = seed;
    do ++met[loop], e = borders.edge(e).next;
    while (e != seed);
  }
  ASSERT_EQ(size, met);
  // The vertices in which several fans meet are known, closed or not.
  const std::vector<VertexId> pinched = borders.pinched();
  for (VertexId v{0}; v < mesh.vertex_count(); ++v) {
    if (mesh.around(v).empty()) continue;
    std::set<TriangleId> fan{mesh.around(v).front()};
    for (std::size_t before = 0; before < fan.size();) {
      before = fan.size();
      for (const TriangleId t : std::set<TriangleId>(fan))
        for (const VertexId w : mesh.corners(t)) {
          if (w == v) continue;
          if (const TriangleId u = mesh.at(v, w); u != EditMesh::none) fan.insert(u);
          if (const TriangleId u = mesh.at(w, v); u != EditMesh::none) fan.insert(u);
        }
    }
    ASSERT_TRUE(fan.size() == mesh.around(v).size() || std::binary_search(pinched.begin(), pinched.end(), v));
  }
  std::size_t border = 0;
  for (const Triangle& t : triangles_of(mesh))
    for (std::size_t k = 0; k < 3; ++k) border += mesh.is_border(VertexId(t.v[k]), VertexId(t.v[(k + 1) % 3]));
  std::size_t held = 0;
  for (const auto& [loop, edges] : size) held += edges;
  ASSERT_EQ(border, held);
}

}  // namespace lodestone::test
