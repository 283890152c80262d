// The makers of hard surfaces. `size`: triangles, about; what has a number of its own ignores it.
#pragma once

#include <cstdint>

#include "core/mesh/hard/polygon_mesh.h"

namespace lodestone::hard {

// A bumpy sphere of unit size around the origin.
[[nodiscard]] PolygonMesh ball(std::uint64_t size);

// faults.cpp: the ball with something wrong.
[[nodiscard]] PolygonMesh not_finite(std::uint64_t size);
[[nodiscard]] PolygonMesh zero_area(std::uint64_t size);
[[nodiscard]] PolygonMesh duplicate_faces(std::uint64_t size);
[[nodiscard]] PolygonMesh opposite_faces(std::uint64_t size);
[[nodiscard]] PolygonMesh unused_vertices(std::uint64_t size);
[[nodiscard]] PolygonMesh soup(std::uint64_t size);
[[nodiscard]] PolygonMesh misoriented(std::uint64_t size);
[[nodiscard]] PolygonMesh inside_out(std::uint64_t size);
[[nodiscard]] PolygonMesh holes(std::uint64_t size);
[[nodiscard]] PolygonMesh needles(std::uint64_t size);
[[nodiscard]] PolygonMesh crossing(std::uint64_t size);

// shapes.cpp: surfaces that are hard by their form or topology.
[[nodiscard]] PolygonMesh fins(std::uint64_t size);
[[nodiscard]] PolygonMesh bow_ties(std::uint64_t size);
[[nodiscard]] PolygonMesh moebius(std::uint64_t size);
[[nodiscard]] PolygonMesh klein(std::uint64_t size);
[[nodiscard]] PolygonMesh plane(std::uint64_t size);
[[nodiscard]] PolygonMesh flat(std::uint64_t size);
[[nodiscard]] PolygonMesh cylinder(std::uint64_t size);
[[nodiscard]] PolygonMesh crease(std::uint64_t size);
[[nodiscard]] PolygonMesh cone(std::uint64_t size);
[[nodiscard]] PolygonMesh wheel(std::uint64_t size);
[[nodiscard]] PolygonMesh comb(std::uint64_t size);
[[nodiscard]] PolygonMesh spiral(std::uint64_t size);
[[nodiscard]] PolygonMesh leaf(std::uint64_t size);
[[nodiscard]] PolygonMesh one_triangle(std::uint64_t size);
[[nodiscard]] PolygonMesh on_a_line(std::uint64_t size);
[[nodiscard]] PolygonMesh in_a_point(std::uint64_t size);
[[nodiscard]] PolygonMesh nothing(std::uint64_t size);

// sizes.cpp: where things are, how large, and how many.
[[nodiscard]] PolygonMesh grid_faces(std::uint64_t size);
[[nodiscard]] PolygonMesh negative(std::uint64_t size);
[[nodiscard]] PolygonMesh outlier(std::uint64_t size);
[[nodiscard]] PolygonMesh long_triangles(std::uint64_t size);
[[nodiscard]] PolygonMesh far_away(std::uint64_t size);
[[nodiscard]] PolygonMesh tiny(std::uint64_t size);
[[nodiscard]] PolygonMesh huge(std::uint64_t size);
[[nodiscard]] PolygonMesh denormal(std::uint64_t size);
[[nodiscard]] PolygonMesh confetti(std::uint64_t size);
[[nodiscard]] PolygonMesh uneven(std::uint64_t size);

}  // namespace lodestone::hard
