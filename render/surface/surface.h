// The surface that the pixels of a group see, and how the stages of shading read its corners.
//
// A *surface* is a triangle for each pixel of the group and the pixel's place on it, as weights of the corners. The
// stages of shading (render/effects) fetch the data of the corners themselves, and only of visible triangles.
#pragma once

#include <bit>
#include <cstddef>

#include "render/surface/lanes.h"
#include "render/surface/shading_job.h"

namespace lodestone::soft::LODESTONE_LANES {

// The place of the pixel on its textures (render/effects/texture_mapping.h).
struct Mapping {
  Float u, v;
  Float u_x, v_x, u_y, v_y;  // differences to the next pixel to the right and downwards
  Points normal;             // of the triangle, in the order of its corners, any length
  Points along_u, along_v;   // gradients of u and v on it
  Points away;               // along the line of sight, either way
};

struct Surface {
  const DrawnCell* cell[width];
  const std::uint32_t* v[width];  // VertexIds
  const ModelFrame* model;        // of all lanes, or null where they see several
  bool morphing;                  // any of the cells
  bool one_triangle;              // all lanes see the same one
  Int seen;                       // mask: the other lanes see nothing, and repeat one that does
  Int x, y;                       // where, subpixels
  Float weight[3];                // perspective-correct, sum 1
  Float depth;                    // in the window, [0, 1]

  Points corner[3];  // drawn positions of the corners, model space; valid if has_corners
  bool has_corners;

  // Results of the stages.
  Points normal;      // model space, of any length
  Points colour;      // albedo, and in the end the colour of the picture
  Float ambient;      // light from everywhere
  Float light;        // sum of the lights that reach it
  Float directional;  // that of the directional light, in it
  Mapping mapping;    // valid if is_mapped
  bool is_mapped;
};

// A number of each lane's model.
template <class Of>
[[gnu::always_inline]] inline Float of_models(const Surface& s, const Of& of) {
  if (s.model) return all(static_cast<float>(of(*s.model)));
  Float values;
  for (int k = 0; k < width; ++k) values[k] = of(*s.cell[k]->model);
  return values;
}
template <class Of>
[[gnu::always_inline]] inline Points vectors_of_models(const Surface& s, const Of& of) {
  return {of_models(s, [&](const ModelFrame& m) { return of(m).x; }),
          of_models(s, [&](const ModelFrame& m) { return of(m).y; }),
          of_models(s, [&](const ModelFrame& m) { return of(m).z; })};
}

// Lambdas of corner i; 1 in cells that do not morph.
[[gnu::always_inline]] inline Float corner_lambdas(const Surface& s, std::size_t i) {
  return as_float(gathered(
      [&](int k) { return std::bit_cast<std::int32_t>(s.cell[k]->morphing ? s.cell[k]->lambdas[s.v[k][i]] : 1.0f); }));
}

// Index of corner i in the coarser cell; only of cells that morph.
[[gnu::always_inline]] inline std::uint32_t parent_of(const Surface& s, int k, std::size_t i) {
  return s.cell[k]->parents[s.v[k][i]];
}

// A value of the surface from those of its corners.
[[gnu::always_inline]] inline Float interpolated(const Surface& s, Float a, Float b, Float c) {
  return (s.weight[0] * a + s.weight[1] * b) + s.weight[2] * c;
}
[[gnu::always_inline]] inline Points interpolated(const Surface& s, const Points& a, const Points& b, const Points& c) {
  return {interpolated(s, a.x, b.x, c.x), interpolated(s, a.y, b.y, c.y), interpolated(s, a.z, b.z, c.z)};
}

// Lambdas of vertices vertex_of(k) of cells cell_of(k): 1 in cells that do not morph.
template <class CellOf, class VertexOf>
[[gnu::always_inline]] inline Float morphed_lambdas(const CellOf& cell_of, const VertexOf& vertex_of) {
  return as_float(gathered([&](int k) {
    const DrawnCell& cell = cell_of(k);
    return std::bit_cast<std::int32_t>(cell.morphing ? cell.lambdas[vertex_of(k)] : 1.0f);
  }));
}

// Drawn positions in normalised model space, as morph_position computes them: in lane k that of vertex vertex_of(k) of
// cell cell_of(k).
template <class CellOf, class VertexOf>
[[gnu::always_inline]] inline Points morphed_positions(const CellOf& cell_of, const VertexOf& vertex_of,
                                                       bool morphing) {
  const float *own[width], *parent[width];
  for (int k = 0; k < width; ++k) {
    const DrawnCell& cell = cell_of(k);
    const std::uint32_t v = vertex_of(k);
    own[k] = &cell.positions[v].x;
    parent[k] = cell.morphing ? &cell.coarser_positions[cell.parents[v]].x : own[k];
  }
  const auto points = [](const float* const(&at)[width]) -> Points {
    const auto q = load_pairs([&](int k) { return at[k]; }, [&](int k) { return at[k] + 1; });
    return {q.a, q.b, q.d};
  };
  const Points w = points(own);
  if (!morphing) return w;
  const Float lambda = morphed_lambdas(cell_of, vertex_of), rest = 1.0f - lambda;
  const Int is_own = lambda >= 1.0f, is_coarser = lambda <= 0.0f;
  const Points p = points(parent);
  const auto mix = [&](Float a, Float b) { return select(is_own, a, select(is_coarser, b, lambda * a + rest * b)); };
  return {mix(w.x, p.x), mix(w.y, p.y), mix(w.z, p.z)};
}

// Positions of corner i.
[[gnu::always_inline]] inline Points corner_positions(const Surface& s, std::size_t i) {
  return morphed_positions([&](int k) -> const DrawnCell& { return *s.cell[k]; }, [&](int k) { return s.v[k][i]; },
                           s.morphing);
}

// Fills Surface::corner. If the whole group sees one triangle, its corners share the lanes.
[[gnu::always_inline]] inline void find_corners(Surface& s) {
  s.has_corners = true;
  if (!s.one_triangle) {
    for (std::size_t i = 0; i < 3; ++i) s.corner[i] = corner_positions(s, i);
    return;
  }
  const Points p = morphed_positions([&](int) -> const DrawnCell& { return *s.cell[0]; },
                                     [&](int k) { return s.v[0][k < 3 ? k : 0]; }, s.morphing);
  for (int i = 0; i < 3; ++i) s.corner[i] = {all(p.x[i]), all(p.y[i]), all(p.z[i])};
}

// From the eye to the surface, in units of clip w. Depth is (z / w + 1) / 2 with z = (far + near) / (far - near) w -
// 2 far near / (far - near).
inline Float distances_from_eye(const ShadingJob& job, const Surface& s) {
  const Lens& lens = job.frame->lens;
  const Float w = lens.near * lens.far / (lens.far - s.depth * (lens.far - lens.near));
  const Float at_x = (to_float(s.x) / job.half_width - 1.0f) * lens.tan_x;
  const Float at_y = (1.0f - to_float(s.y) / job.half_height) * lens.tan_y;
  return w * sqrt(1.0f + (at_x * at_x + at_y * at_y));
}

inline Points cross(const Points& a, const Points& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Points difference(const Points& a, const Points& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Float dot(const Points& a, const Points& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Points select(Int mask, const Points& yes, const Points& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
inline Points scaled(Float factor, const Points& p) { return {factor * p.x, factor * p.y, factor * p.z}; }

}  // namespace lodestone::soft::LODESTONE_LANES
