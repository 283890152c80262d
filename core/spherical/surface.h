// The surface that is mapped to the sphere: plain data that the parts of core/spherical hand to each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone::spherical {

inline constexpr std::uint32_t no_source = 0xFFFF'FFFFu;

// The source of a vertex: a vertex of the input (a == b), the middle of the edge between two of its vertices, or
// nothing that the input has (no_source).
struct SourceVertex {
  std::uint32_t a = no_source, b = no_source;
  constexpr SourceVertex(std::uint32_t vertex) : a(vertex), b(vertex) {}  // implicit, as most are vertices
  constexpr SourceVertex(std::uint32_t from, std::uint32_t to) : a(from), b(to) {}
  [[nodiscard]] bool is_vertex() const { return a == b && a != no_source; }
  [[nodiscard]] bool is_middle() const { return a != b; }
  friend constexpr bool operator==(const SourceVertex&, const SourceVertex&) = default;
};

// One component, in double precision; closed, oriented and of genus 0 once core/spherical/topology has made it so.
struct Surface {
  std::vector<Vec3d> positions;  // scaled so that the longest extent of the whole input is 1
  std::vector<Triangle> triangles;
  std::vector<SourceVertex> source_vertex;     // by vertex
  std::vector<std::uint32_t> source_triangle;  // by triangle: the input's; no_source if it fills a hole or caps a cut
};

// Counts that tell what a triangle mesh is, as far as its connectivity is concerned.
struct SurfaceKind {
  std::uint64_t components = 0;  // of triangles that share vertices
  std::int64_t euler = 0;        // used vertices - edges + triangles
  std::uint64_t open_edges = 0;  // without exactly one triangle on each side: borders, nonmanifold or clashing edges
  std::uint64_t split_fans = 0;  // further fans at vertices with several; not counted if any triangle is degenerate
  std::uint64_t degenerate = 0;  // triangles with two equal corners
  std::uint64_t unused = 0;      // vertices of no triangle
  friend bool operator==(const SurfaceKind&, const SurfaceKind&) = default;
};

// The kind of any triangles with corners below vertex_count. Sorts the edges: n log n; about 60 bytes per triangle.
[[nodiscard]] SurfaceKind kind_of(std::span<const Triangle> triangles, std::size_t vertex_count);

// One closed, oriented, manifold component of genus 0 without unused vertices: what can be mapped to the sphere.
[[nodiscard]] bool is_sphere(const Surface& surface);

}  // namespace lodestone::spherical
