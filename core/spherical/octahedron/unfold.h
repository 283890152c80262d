// Cuts a mesh on the sphere open along the four arcs from the south pole to the equator, and lays it into the square.
//
// Triangles that an arc crosses are split on it, so that every triangle lies on one side of the cut and every vertex on
// the cut has its copies exactly on the sides of the square. Rejected: corners outside the square, which show the wrong
// part of the image wherever textures are clamped, and which no collapse towards a coarser level can keep.
//
// Images show the surface over the sphere, triangles are drawn with straight sides in the square: where a side is long
// the two part, and a wall showed an arc of what lies beyond its foot. Edges are halved until their middles are near
// enough, worst first, by at most 256 and a quarter more triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "core/spherical/octahedron/octahedral_map.h"

namespace lodestone::spherical {

// A vertex that a split has added, in a triangle of the input or on its border: the sum of its corners' values, times
// the weights (not negative, of sum 1), is its value of anything that is linear over the triangle. Unused corners have
// weight 0.
struct AddedVertex {
  std::array<std::uint32_t, 3> corner{};
  std::array<double, 3> weight{};
};

// Wedges that lie on the cut: copies of one vertex, wedges [first, first + count), 2 of them, or 4 at the south pole.
// They are to be collapsed at once.
struct CutVertex {
  std::uint32_t vertex = 0, first = 0, count = 0;
};

struct Unfolding {
  std::vector<Vec3d> directions;      // of the input's vertices, then of those added
  std::vector<AddedVertex> added;     // vertices directions.size() - added.size() and on
  std::vector<Triangle> triangles;    // of vertices; a split triangle is replaced by a part, others are at the end
  std::vector<std::uint32_t> source;  // by triangle: the input's
  std::vector<std::uint32_t> vertex;  // by wedge, ascending
  std::vector<SquarePoint> place;     // by wedge
  std::vector<Triangle> corners;      // by triangle: its wedges
  std::vector<CutVertex> cut;         // by vertex, ascending
};

// A closed mesh with one unit direction per vertex, its triangles counter-clockwise seen from outside the sphere; with
// several components, each covers the sphere alone and is unfolded alone. Directions of vertices within rounding of the
// south pole or an end of an arc are set onto it. Throws InputError if the triangles do not cover one of those points.
// Linear time; about 150 bytes per triangle.
// `most_bend`: how far the middle of an edge may be in the square from where the image has it; 1 allows anything.
[[nodiscard]] Unfolding unfold(std::span<const Triangle> triangles, std::span<const Vec3d> directions,
                               double most_bend = 1);

}  // namespace lodestone::spherical
