// The surfaces that pixels of the visibility buffer see (render/surface/surface.h).
#pragma once

#include <cstddef>

#include "render/backends/soft/clip.h"
#include "render/backends/soft/kernels.h"
#include "render/surface/surface.h"

namespace lodestone::soft::LODESTONE_LANES {

// Weights at (x, y), in subpixels, on the records of a group, in the lanes of `valid`. Linear on the surface is linear
// in the window after division by w: shares over w, in proportion. The share of a corner is the edge function of the
// opposite edge, exact in double; their common factor does not matter.
template <class RecordOf>
[[gnu::always_inline]] inline void find_weights(const ResolveJob& job, const RecordOf& record, unsigned valid, Int x,
                                                Int y, Surface& s) {
  static_assert(offsetof(TriangleRecord, z) == 24 && offsetof(TriangleRecord, inverse_w) == 36);
  const auto quads = [&](int number) {
    return load_quads<Float>([&](int k) { return reinterpret_cast<const float*>(&record(k)) + 4 * number; });
  };
  const Quads<Float> ab = quads(0), cz = quads(1), zw = quads(2);
  const auto cross = [](Double ax, Double ay, Double bx, Double by) { return to_float(ax * by - ay * bx); };
  const auto from_point = [](Float p, Int q) { return to_double(as_int(p) - q); };
  const Double ax = from_point(ab.a, x), ay = from_point(ab.b, y), bx = from_point(ab.c, x), by = from_point(ab.d, y),
               cx = from_point(cz.a, x), cy = from_point(cz.b, y);
  const Float wa = cross(bx, by, cx, cy) * zw.b, wb = cross(cx, cy, ax, ay) * zw.c, wc = cross(ax, ay, bx, by) * zw.d;
  const Float scale = 1.0f / ((wa + wb) + wc);
  s.weight[0] = scale * wa, s.weight[1] = scale * wb, s.weight[2] = scale * wc;
  for (unsigned clipped = bits(zw.b == 0.0f) & valid; clipped != 0; clipped &= clipped - 1) {
    const int k = std::countr_zero(clipped);
    const std::array<float, 3> w = clipped_weights(*s.cell[k], record(k).v, *job.viewport, {x[k], y[k]});
    for (std::size_t i = 0; i < 3; ++i) s.weight[i][k] = w[i];
  }
}

[[gnu::always_inline]] inline const ModelFrame* model_of_all(const ResolveJob& job, const Surface& s) {
  const ModelFrame* first = s.cell[0]->model;
  if (job.frame->models.size() == 1) return first;
  for (int k = 1; k < width; ++k)
    if (s.cell[k]->model != first) return nullptr;
  return first;
}

// The surfaces that the references name at (x, y), in subpixels. Fragments hold their own weights.
[[gnu::always_inline]] inline void find_surface(const ResolveJob& job, const TileSources& sources, Int group, Int x,
                                                Int y, Surface& s) {
  static_assert(offsetof(Fragment, weight_b) == 24 && sizeof(Fragment) == 32);
  s.x = x, s.y = y;
  const Fragment* fragment[width]{};
  const TriangleRecord* record[width]{};
  const Fragment* any_fragment = nullptr;
  const TriangleRecord* any_record = nullptr;
  const Int is_record = group < 0;
  std::uint32_t references[width];
  store(references, group);
  bool morphing = false;
  for (int k = 0; k < width; ++k) {
    TriangleNumber number;
    if (Reference::is_record(references[k])) {
      any_record = record[k] = &sources.record(references[k]);
      number = record[k]->triangle;
      s.v[k] = record[k]->v.data();
    } else {
      any_fragment = fragment[k] = &sources.fragment(references[k]);
      number = fragment[k]->triangle;
      s.v[k] = fragment[k]->v.data();
    }
    s.cell[k] = &job.drawn->cell_of(number);
    morphing |= s.cell[k]->morphing;
  }
  s.morphing = morphing;
  s.one_triangle = bits(group == group[0]) == all_lanes;
  s.model = model_of_all(job, s);
  if (any_record) {
    const auto of = [&](int k) -> const TriangleRecord& {
      return Reference::is_record(references[k]) ? *record[k] : *any_record;
    };
    find_weights(job, of, bits(is_record), x, y, s);
    if (!any_fragment) return;
  }
  const auto q = load_quads<Float>([&](int k) {
    const Fragment* f = Reference::is_record(references[k]) ? any_fragment : fragment[k];
    return reinterpret_cast<const float*>(f) + 4;
  });
  const Float a = (1.0f - q.c) - q.d;
  if (!any_record) {
    s.weight[0] = a, s.weight[1] = q.c, s.weight[2] = q.d;
  } else {
    s.weight[0] = select(is_record, s.weight[0], a);
    s.weight[1] = select(is_record, s.weight[1], q.c);
    s.weight[2] = select(is_record, s.weight[2], q.d);
  }
}

}  // namespace lodestone::soft::LODESTONE_LANES
