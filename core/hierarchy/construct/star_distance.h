// Measures the distance of the vertices of a level from the surface of the next coarser one, of which |v - P(v)| is
// only a bound.
//
// A vertex mostly slides along the surface to its parent; the bound of (1) counts all of that way as error. Here the
// distance to the triangles around the parent is measured, then to neighbouring ones as long as they are nearer: never
// less than the distance of the vertex from the surface, and nearly always equal. Points between the vertices may be
// farther.
//
// Queries take the time of a few stars; around a vertex of many triangles, of which a hub may have all, that of a
// search in a tree of its neighbourhood, made when it is first needed (some 600 bytes for each of those triangles).
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/base/id.h"
#include "core/math/vec3.h"
#include "core/mesh/indexed_mesh.h"
#include "core/spatial/triangle_bvh.h"

namespace lodestone {

class StarDistance {
 public:
  // The coarse triangles by vertex; degenerate ones are passed over. The spans must outlive the queries.
  void reset(std::span<const Triangle> triangles, std::span<const Vec3f> positions);

  // The larger of `known` and the squared distance of p from the surface near `vertex`; from the vertex itself if it
  // has no triangle. Stops at the first triangle within `known`: with a running maximum most queries end at their first
  // triangle.
  [[nodiscard]] double farther(double known, Vec3f p, VertexId vertex);

 private:
  static constexpr TriangleId none{0xffff'ffffu};
  struct Nearest {
    double squared = 0;
    TriangleId triangle = none;
  };
  struct Neighbourhood {
    std::vector<std::uint32_t> triangles;
    TriangleBvh tree;
  };
  [[nodiscard]] bool is_large(VertexId vertex) const;
  [[nodiscard]] const Neighbourhood& neighbourhood(VertexId vertex);
  [[nodiscard]] std::vector<std::uint32_t> triangles_near(VertexId vertex) const;
  [[nodiscard]] bool is_near(double known, const Vec3d& p, VertexId vertex) const;
  void search_star(double known, const Vec3d& p, VertexId vertex, Nearest& nearest);
  void search_around(double known, const Vec3d& p, TriangleId triangle, Nearest& nearest);

  std::span<const Triangle> triangles_;
  std::span<const Vec3f> positions_;
  std::vector<std::uint32_t> first_;     // of each vertex in `incident_`; one more entry than vertices
  std::vector<std::uint32_t> incident_;  // triangles
  std::unordered_map<VertexId, Neighbourhood> neighbourhoods_;  // of vertices with large stars
};

}  // namespace lodestone
